// What takes the coefficients of the regions, each in a basis of its own, to those of the parts of
// the detail basis: a sparse matrix of blocks, one for each region and each part that it moves.
// Source: docs/method/learner.md#parts.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "absl/status/statusor.h"
#include "pleat/base/large_page_allocator.h"

namespace pleat {

// What a model file holds: out[first_output + j] += sum_i weights(i, j) in[first_input + i].
struct CoefficientFoldBlock {
  int first_input = 0, first_output = 0;
  Eigen::MatrixXf weights;  // inputs x outputs of the block
};

// Immutable: queries share it without locks.
class CoefficientFold {
 public:
  // The memory of one thread, reused without allocation.
  struct Workspace {
    std::vector<float> part;  // the outputs of a block, filled up to whole registers
  };

  // kInvalidArgument when a block is empty, not finite or beyond the inputs or outputs.
  static absl::StatusOr<CoefficientFold> FromBlocks(std::vector<CoefficientFoldBlock> blocks,
                                                    int num_inputs, int num_outputs);
  std::vector<CoefficientFoldBlock> blocks() const;

  int num_inputs() const { return num_inputs_; }
  int num_outputs() const { return num_outputs_; }
  size_t memory_bytes() const { return weights_.size() * sizeof(float); }

  // Takes the inputs of several queries to their outputs. The blocks are added in their order, so
  // several queries give the bits of single ones.
  struct Query {
    const float* inputs = nullptr;   // num_inputs()
    float* outputs = nullptr;        // num_outputs()
    Workspace* workspace = nullptr;  // another for each query
  };
  void Apply(std::span<const Query> queries) const;

 private:
  struct Block {
    int first_input, first_output;
    Eigen::Index num_inputs, num_outputs;
  };

  int num_inputs_ = 0, num_outputs_ = 0;
  std::vector<Block> blocks_;
  // The weights of all blocks, row by row; each row is filled up with zeros to whole registers.
  std::vector<float, LargePageAllocator<float>> weights_;
};

}  // namespace pleat
