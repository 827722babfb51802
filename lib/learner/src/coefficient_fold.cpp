#include "pleat/learner/coefficient_fold.h"

#include <algorithm>
#include <array>
#include <cassert>

#include "absl/strings/str_cat.h"
#include "pleat/simd/weighted_rows.h"
#include "register_rows.h"

namespace pleat {

absl::StatusOr<CoefficientFold> CoefficientFold::FromBlocks(
    std::vector<CoefficientFoldBlock> blocks, int num_inputs, int num_outputs) {
  CoefficientFold fold;
  fold.num_inputs_ = num_inputs;
  fold.num_outputs_ = num_outputs;
  size_t size = 0;
  for (const CoefficientFoldBlock& block : blocks) {
    const Eigen::Index rows = block.weights.rows(), cols = block.weights.cols();
    if (rows < 1 || cols < 1 || block.first_input < 0 || block.first_output < 0 ||
        rows > num_inputs - block.first_input || cols > num_outputs - block.first_output ||
        !block.weights.allFinite()) {
      return absl::InvalidArgumentError(
          absl::StrCat("fold of the regions: a block of ", rows, " x ", cols, " from ",
                       block.first_input, " to ", block.first_output,
                       " is not finite or not within ", num_inputs, " x ", num_outputs));
    }
    fold.blocks_.push_back({block.first_input, block.first_output, rows, cols});
    size += static_cast<size_t>(rows * FilledUp(cols));
  }
  fold.weights_.assign(size, 0);
  float* weights = fold.weights_.data();
  for (const CoefficientFoldBlock& block : blocks) {
    const Eigen::Index rows = block.weights.rows(), stride = FilledUp(block.weights.cols());
    Eigen::Map<RowMajorFloats>(weights, rows, stride).leftCols(block.weights.cols()) =
        block.weights;
    weights += rows * stride;
  }
  return fold;
}

std::vector<CoefficientFoldBlock> CoefficientFold::blocks() const {
  std::vector<CoefficientFoldBlock> blocks;
  const float* weights = weights_.data();
  for (const Block& block : blocks_) {
    const Eigen::Index stride = FilledUp(block.num_outputs);
    const Eigen::Map<const RowMajorFloats> rows(weights, block.num_inputs, stride);
    blocks.push_back({block.first_input, block.first_output, rows.leftCols(block.num_outputs)});
    weights += block.num_inputs * stride;
  }
  return blocks;
}

void CoefficientFold::Apply(std::span<const Query> queries) const {
  std::array<const float*, kMaxWeightedTogether> factors{};
  std::array<float*, kMaxWeightedTogether> sums{};
  for (size_t begin = 0; begin < queries.size(); begin += kMaxWeightedTogether) {
    const auto together =
        queries.subspan(begin, std::min<size_t>(kMaxWeightedTogether, queries.size() - begin));
    for (const Query& query : together) std::fill_n(query.outputs, num_outputs_, 0.f);
    const float* weights = weights_.data();
    for (const Block& block : blocks_) {
      const Eigen::Index stride = FilledUp(block.num_outputs);
      for (size_t q = 0; q < together.size(); ++q) {
        std::vector<float>& part = together[q].workspace->part;
        part.assign(static_cast<size_t>(stride), 0);
        std::copy_n(together[q].outputs + block.first_output, block.num_outputs, part.data());
        factors[q] = together[q].inputs + block.first_input;
        sums[q] = part.data();
      }
      AddWeightedRows({factors.data(), together.size()}, weights, block.num_inputs, stride,
                      {sums.data(), together.size()});
      for (size_t q = 0; q < together.size(); ++q) {
        std::copy_n(sums[q], block.num_outputs, together[q].outputs + block.first_output);
      }
      weights += block.num_inputs * stride;
    }
  }
}

}  // namespace pleat
