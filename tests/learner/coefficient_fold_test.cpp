#include "pleat/learner/coefficient_fold.h"

#include <gtest/gtest.h>

#include <limits>

#include "support/allocation_counter.h"
#include "support/random_data.h"
#include "support/status_matchers.h"

namespace pleat {
namespace {

using ::testing::HasSubstr;

constexpr int kNumInputs = 50, kNumOutputs = 61;

// Blocks of many sizes, of which some add to the same outputs.
std::vector<CoefficientFoldBlock> Blocks() {
  std::vector<CoefficientFoldBlock> blocks;
  const int places[][4] = {{0, 0, 20, 33}, {20, 0, 30, 16}, {20, 30, 7, 31}, {49, 60, 1, 1}};
  for (const auto& [first_input, first_output, rows, cols] : places) {
    blocks.push_back({first_input, first_output, RandomMatrix(rows, cols, rows).cast<float>()});
  }
  return blocks;
}

TEST(CoefficientFoldTest, IsTheMatrixOfItsBlocks) {
  PLEAT_ASSERT_OK_AND_ASSIGN(const CoefficientFold fold,
                             CoefficientFold::FromBlocks(Blocks(), kNumInputs, kNumOutputs));
  Eigen::MatrixXd dense = Eigen::MatrixXd::Zero(kNumInputs, kNumOutputs);
  for (const CoefficientFoldBlock& block : Blocks()) {
    dense.block(block.first_input, block.first_output, block.weights.rows(),
                block.weights.cols()) += block.weights.cast<double>();
  }
  constexpr int kNumQueries = 7;
  const Eigen::MatrixXf inputs = RandomMatrix(kNumInputs, kNumQueries, 4).cast<float>();
  Eigen::MatrixXf outputs = Eigen::MatrixXf::Constant(kNumOutputs, kNumQueries, 99), one = outputs;
  std::vector<CoefficientFold::Workspace> workspaces(kNumQueries);
  std::vector<CoefficientFold::Query> queries;
  for (int q = 0; q < kNumQueries; ++q) {
    queries.push_back({inputs.col(q).data(), outputs.col(q).data(), &workspaces[q]});
  }
  fold.Apply(queries);
  EXPECT_LT((outputs.cast<double>() - dense.transpose() * inputs.cast<double>()).norm(), 1e-4);
  for (int q = 0; q < kNumQueries; ++q) {
    queries[q].outputs = one.col(q).data();
    fold.Apply({&queries[q], 1});
    EXPECT_EQ(one.col(q), outputs.col(q)) << "together and alone";
  }
  if (NumAllocations() < 0) GTEST_SKIP() << "allocations cannot be counted in this build";
  const long before = NumAllocations();
  fold.Apply(queries);
  EXPECT_EQ(NumAllocations(), before);
}

TEST(CoefficientFoldTest, BlocksRoundTrip) {
  PLEAT_ASSERT_OK_AND_ASSIGN(const CoefficientFold fold,
                             CoefficientFold::FromBlocks(Blocks(), kNumInputs, kNumOutputs));
  const std::vector<CoefficientFoldBlock> expected = Blocks(), found = fold.blocks();
  ASSERT_EQ(found.size(), expected.size());
  for (size_t i = 0; i < found.size(); ++i) {
    EXPECT_EQ(found[i].first_input, expected[i].first_input);
    EXPECT_EQ(found[i].first_output, expected[i].first_output);
    EXPECT_EQ(found[i].weights, expected[i].weights);
  }
}

TEST(CoefficientFoldTest, RefusesBlocksOutOfRange) {
  const auto refused = [](auto change) {
    std::vector<CoefficientFoldBlock> blocks = Blocks();
    change(blocks[1]);
    EXPECT_THAT(CoefficientFold::FromBlocks(blocks, kNumInputs, kNumOutputs),
                HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("fold of the regions")));
  };
  refused([](auto& block) { block.first_input = 21; });
  refused([](auto& block) { block.first_input = -1; });
  refused([](auto& block) { block.first_output = 46; });
  refused([](auto& block) { block.first_output = -1; });
  refused([](auto& block) { block.weights.resize(0, 16); });
  refused([](auto& block) { block.weights(2, 3) = std::numeric_limits<float>::quiet_NaN(); });
}

}  // namespace
}  // namespace pleat
