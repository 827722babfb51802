// What takes the coefficients of the regions, each in a basis of its own, to those of the parts of
// the detail basis: a sparse matrix of blocks, one for each region, with rows for the coefficients
// of all parts that it moves. The features of the skin are computed by such a matrix too. Source:
// docs/method/learner.md#parts.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "absl/status/statusor.h"
#include "pleat/learner/detail_basis.h"

namespace pleat {

// What a model file holds: out[rows] += weights in[first_input ...], with weights in planes of
// 8-bit integers, as those of a detail basis (a block is a basis without a mean).
struct CoefficientFoldBlock {
  // A run of outputs that a block adds to.
  struct Target {
    int first_output = 0, count = 0;
  };
  int first_input = 0;
  std::vector<Target> targets;    // their counts add up to the rows of the weights
  DetailBasisParameters weights;  // outputs x inputs of the block, of mean zero

  // Rounds the weights (outputs x inputs, all outputs to `targets`): input i gets planes until its
  // step is at most largest_steps[i]; see DetailBasis::Quantize.
  static absl::StatusOr<CoefficientFoldBlock> Round(
      int first_input, std::vector<Target> targets, const Eigen::MatrixXd& weights,
      const Eigen::Ref<const Eigen::VectorXd>& largest_steps);
  // The weights as they were rounded, outputs x inputs.
  Eigen::MatrixXd Dense() const;
};

// Immutable: queries share it without locks.
class CoefficientFold {
 public:
  // The memory of one thread, reused without allocation.
  struct Workspace {
    DetailBasis::Query query;   // the inputs of a block, rounded
    std::vector<float> output;  // those of a block, filled up to whole blocks of its planes
  };

  // kInvalidArgument when a block is empty, not finite or beyond the inputs or outputs.
  static absl::StatusOr<CoefficientFold> FromBlocks(std::vector<CoefficientFoldBlock> blocks,
                                                    int num_inputs, int num_outputs);
  std::vector<CoefficientFoldBlock> blocks() const;

  int num_inputs() const { return num_inputs_; }
  int num_outputs() const { return num_outputs_; }
  size_t memory_bytes() const;

  // Takes the inputs of several queries to their outputs. The blocks are added in their order, so
  // several queries give the bits of single ones.
  struct Query {
    const float* inputs = nullptr;   // num_inputs(), finite
    float* outputs = nullptr;        // num_outputs()
    Workspace* workspace = nullptr;  // another for each query
  };
  void Apply(std::span<const Query> queries) const;

 private:
  struct Block {
    int first_input;
    std::vector<CoefficientFoldBlock::Target> targets;
    int num_outputs;
    // Its details are the outputs in the order in which ExpandBlocks gives them.
    DetailBasis weights;
  };
  static constexpr size_t kMostTogether = 16;  // queries that go through a block together

  int num_inputs_ = 0, num_outputs_ = 0;
  std::vector<Block> blocks_;
};

}  // namespace pleat
