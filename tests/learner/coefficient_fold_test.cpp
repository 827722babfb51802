#include "pleat/learner/coefficient_fold.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "support/allocation_counter.h"
#include "support/random_data.h"
#include "support/status_matchers.h"

namespace pleat {
namespace {

using ::testing::HasSubstr;

constexpr int kNumInputs = 50, kNumOutputs = 61;

using Target = CoefficientFoldBlock::Target;

// Blocks of many sizes, of which some add to the same outputs and one has two targets.
std::vector<CoefficientFoldBlock> Blocks(double largest_step = 0) {
  struct Place {
    int first_input, num_inputs;
    std::vector<Target> targets;
  };
  const std::vector<Place> places = {{0, 20, {{0, 33}}},
                                     {20, 30, {{0, 16}, {30, 31}, {2, 49}}},
                                     {20, 30, {{5, 7}}},
                                     {49, 1, {{60, 1}}}};
  std::vector<CoefficientFoldBlock> blocks;
  for (const Place& place : places) {
    int num_outputs = 0;
    for (const Target& target : place.targets) num_outputs += target.count;
    blocks.push_back(
        CoefficientFoldBlock::Round(place.first_input, place.targets,
                                    RandomMatrix(num_outputs, place.num_inputs, num_outputs),
                                    Eigen::VectorXd::Constant(place.num_inputs, largest_step))
            .value());
  }
  return blocks;
}

// outputs x inputs.
Eigen::MatrixXd DenseOf(const std::vector<CoefficientFoldBlock>& blocks) {
  Eigen::MatrixXd dense = Eigen::MatrixXd::Zero(kNumOutputs, kNumInputs);
  for (const CoefficientFoldBlock& block : blocks) {
    const Eigen::MatrixXd weights = block.Dense();
    Eigen::Index begin = 0;
    for (const Target& target : block.targets) {
      dense.block(target.first_output, block.first_input, target.count, weights.cols()) +=
          weights.middleRows(begin, target.count);
      begin += target.count;
    }
  }
  return dense;
}

TEST(CoefficientFoldTest, RoundingKeepsTheStepsThatAreAskedFor) {
  const Eigen::MatrixXd weights = RandomMatrix(9, 2, 4);
  const Eigen::Vector2d steps(.1, 1e-4);
  PLEAT_ASSERT_OK_AND_ASSIGN(const CoefficientFoldBlock block,
                             CoefficientFoldBlock::Round(0, {{0, 9}}, weights, steps));
  const Eigen::VectorXd errors = (block.Dense() - weights).cwiseAbs().colwise().maxCoeff();
  EXPECT_LE(errors[0], .05);
  EXPECT_LE(errors[1], .5e-4);
  EXPECT_EQ(block.weights.components, (std::vector<int>{0, 1, 1}));
}

TEST(CoefficientFoldTest, IsTheMatrixOfItsBlocks) {
  PLEAT_ASSERT_OK_AND_ASSIGN(const CoefficientFold fold,
                             CoefficientFold::FromBlocks(Blocks(), kNumInputs, kNumOutputs));
  constexpr int kNumQueries = 7;
  const Eigen::MatrixXf inputs = RandomMatrix(kNumInputs, kNumQueries, 4).cast<float>();
  Eigen::MatrixXf outputs = Eigen::MatrixXf::Constant(kNumOutputs, kNumQueries, 99), one = outputs;
  std::vector<CoefficientFold::Workspace> workspaces(kNumQueries);
  std::vector<CoefficientFold::Query> queries;
  for (int q = 0; q < kNumQueries; ++q) {
    queries.push_back({inputs.col(q).data(), outputs.col(q).data(), &workspaces[q]});
  }
  fold.Apply(queries);
  const Eigen::MatrixXd expected = DenseOf(Blocks()) * inputs.cast<double>();
  EXPECT_LT((outputs.cast<double>() - expected).norm(), 1e-3 * expected.norm());
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
    EXPECT_EQ(found[i].weights.values, expected[i].weights.values);
    EXPECT_EQ(found[i].weights.scales, expected[i].weights.scales);
  }
  EXPECT_EQ(DenseOf(found), DenseOf(expected));
}

TEST(CoefficientFoldTest, ABlockWithoutPlanesAddsNothing) {
  std::vector<CoefficientFoldBlock> blocks = Blocks();
  blocks[1].weights.values.resize(Eigen::NoChange, 0);
  blocks[1].weights.components.clear();
  blocks[1].weights.scales.clear();
  PLEAT_ASSERT_OK_AND_ASSIGN(const CoefficientFold fold,
                             CoefficientFold::FromBlocks(blocks, kNumInputs, kNumOutputs));
  EXPECT_EQ(DenseOf(fold.blocks()), DenseOf(blocks));
  EXPECT_EQ(fold.blocks()[1].weights.values.rows(), blocks[1].weights.values.rows());
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
  refused([](auto& block) { block.targets[1].first_output = 31; });
  refused([](auto& block) { block.targets[1].first_output = -1; });
  refused([](auto& block) { block.targets[1].count = 0; });
  refused([](auto& block) { block.targets.pop_back(); });
  refused([](auto& block) { block.weights.values(2, 3) = -128; });
  refused([](auto& block) { block.weights.scales[3] = std::nanf(""); });
}

}  // namespace
}  // namespace pleat
