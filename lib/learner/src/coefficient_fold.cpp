// The weights of a block are a DetailBasis, whose kernel sums planes of integers for 48 rows at a
// time. It gives the rows of 48 in the order of 16 vertices: x of all, y of all, z of all. Outputs
// have no axes, so the rows are put where that order returns them one after the other, and the last
// 48 are filled up with zeros.
#include "pleat/learner/coefficient_fold.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <utility>

#include "absl/strings/str_cat.h"
#include "pleat/base/status.h"

namespace pleat {
namespace {

constexpr int kBlockRows = DetailBasis::kBlockDetails;

absl::Status RefuseFold(const std::string& what) {
  return absl::InvalidArgumentError("fold of the regions: " + what);
}

// The row of the basis that comes out as output `i`.
int RowOf(int i) {
  constexpr int kLanes = DetailBasis::kLanes;
  const int in_block = i % kBlockRows;
  return i - in_block + in_block % kLanes * 3 + in_block / kLanes;
}

// The sum of the counts, or -1 when a target is empty or beyond the outputs.
int64_t CountOutputs(const std::vector<CoefficientFoldBlock::Target>& targets, int num_outputs) {
  int64_t count = 0;
  for (const CoefficientFoldBlock::Target& target : targets) {
    if (target.first_output < 0 || target.count < 1 ||
        target.count > num_outputs - target.first_output) {
      return -1;
    }
    count += target.count;
  }
  return count;
}

absl::StatusOr<DetailBasis> InOrderOfBlocks(const DetailBasisParameters& weights) {
  const int num_outputs = static_cast<int>(weights.values.rows());
  const int padded = (num_outputs + kBlockRows - 1) / kBlockRows * kBlockRows;
  DetailBasisParameters placed = weights;
  placed.mean = Eigen::VectorXf::Zero(padded);
  placed.values.setZero(padded, weights.values.cols());
  for (Eigen::Index p = 0; p < weights.values.cols(); ++p) {  // a block may have no planes
    for (int i = 0; i < num_outputs; ++i) placed.values(RowOf(i), p) = weights.values(i, p);
  }
  return DetailBasis::FromParameters(placed);
}

}  // namespace

absl::StatusOr<CoefficientFoldBlock> CoefficientFoldBlock::Round(
    int first_input, std::vector<Target> targets, const Eigen::MatrixXd& weights,
    const Eigen::Ref<const Eigen::VectorXd>& largest_steps) {
  PLEAT_ASSIGN_OR_RETURN(
      const DetailBasis rounded,
      DetailBasis::Quantize(Eigen::VectorXf::Zero(weights.rows()), weights, largest_steps));
  return CoefficientFoldBlock{first_input, std::move(targets), rounded.parameters()};
}

Eigen::MatrixXd CoefficientFoldBlock::Dense() const {
  Eigen::MatrixXd dense = Eigen::MatrixXd::Zero(weights.values.rows(), weights.num_components);
  for (size_t p = 0; p < weights.components.size(); ++p) {
    dense.col(weights.components[p]) +=
        double{weights.scales[p]} * weights.values.col(static_cast<Eigen::Index>(p)).cast<double>();
  }
  return dense;
}

absl::StatusOr<CoefficientFold> CoefficientFold::FromBlocks(
    std::vector<CoefficientFoldBlock> blocks, int num_inputs, int num_outputs) {
  CoefficientFold fold;
  fold.num_inputs_ = num_inputs;
  fold.num_outputs_ = num_outputs;
  for (CoefficientFoldBlock& block : blocks) {
    const int64_t rows = CountOutputs(block.targets, num_outputs);
    if (rows < 1 || rows != block.weights.values.rows() || rows != block.weights.mean.size() ||
        block.first_input < 0 || block.weights.num_components > num_inputs - block.first_input) {
      return RefuseFold(absl::StrCat(
          "a block of ", block.weights.values.rows(), " x ", block.weights.num_components, " from ",
          block.first_input, " does not fit its ", block.targets.size(), " targets or is not ",
          "within ", num_outputs, " x ", num_inputs));
    }
    auto weights = InOrderOfBlocks(block.weights);
    if (!weights.ok()) return RefuseFold(std::string(weights.status().message()));
    fold.blocks_.push_back(
        {block.first_input, std::move(block.targets), static_cast<int>(rows), *std::move(weights)});
  }
  return fold;
}

std::vector<CoefficientFoldBlock> CoefficientFold::blocks() const {
  std::vector<CoefficientFoldBlock> blocks;
  for (const Block& block : blocks_) {
    DetailBasisParameters weights = block.weights.parameters();
    const DetailBasisParameters::Planes placed = std::move(weights.values);
    weights.values.resize(block.num_outputs, placed.cols());
    for (Eigen::Index p = 0; p < placed.cols(); ++p) {
      for (int i = 0; i < block.num_outputs; ++i) weights.values(i, p) = placed(RowOf(i), p);
    }
    weights.mean.setZero(block.num_outputs);
    blocks.push_back({block.first_input, block.targets, std::move(weights)});
  }
  return blocks;
}

size_t CoefficientFold::memory_bytes() const {
  size_t bytes = 0;
  for (const Block& block : blocks_) bytes += sizeof(Block) + block.weights.memory_bytes();
  return bytes;
}

void CoefficientFold::Apply(std::span<const Query> queries) const {
  std::array<const DetailBasis::Query*, kMostTogether> rounded{};
  std::array<float*, kMostTogether> outputs{};
  for (size_t begin = 0; begin < queries.size(); begin += kMostTogether) {
    const auto together = queries.subspan(begin, std::min(kMostTogether, queries.size() - begin));
    for (const Query& query : together) std::fill_n(query.outputs, num_outputs_, 0.f);
    for (const Block& block : blocks_) {
      const int num_blocks = block.weights.num_blocks();
      for (size_t q = 0; q < together.size(); ++q) {
        Workspace& w = *together[q].workspace;
        const Eigen::Map<const Eigen::VectorXf> inputs(together[q].inputs + block.first_input,
                                                       block.weights.num_components());
        block.weights.SetCoefficients(inputs, &w.query);
        w.output.resize(static_cast<size_t>(num_blocks) * kBlockRows);
        rounded[q] = &w.query;
        outputs[q] = w.output.data();
      }
      block.weights.ExpandBlocks({rounded.data(), together.size()}, 0, num_blocks,
                                 {outputs.data(), together.size()});
      for (size_t q = 0; q < together.size(); ++q) {
        const float* source = outputs[q];
        for (const CoefficientFoldBlock::Target& target : block.targets) {
          float* sum = together[q].outputs + target.first_output;
          for (int i = 0; i < target.count; ++i) sum[i] += source[i];
          source += target.count;
        }
      }
    }
  }
}

}  // namespace pleat
