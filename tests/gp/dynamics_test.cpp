#include "dynamics.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numeric>

#include "support/random_data.h"

namespace pleat {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

TEST(DynamicsTest, NoFrameIsPredictedAcrossTwoClips) {
  const DynamicsRows first = MakeDynamicsRows({0, 3}, 6, 1);
  EXPECT_THAT(first.firsts, ElementsAre(0, 3));
  EXPECT_THAT(first.targets, ElementsAre(1, 2, 4, 5));
  const DynamicsRows second = MakeDynamicsRows({0, 3}, 6, 2);
  EXPECT_THAT(second.firsts, ElementsAre(0, 1, 3, 4));
  EXPECT_THAT(second.targets, ElementsAre(2, 5));
}

TEST(DynamicsTest, ClipsShorterThanTheHistoryPredictNothing) {
  const DynamicsRows rows = MakeDynamicsRows({0, 1, 3}, 5, 2);
  EXPECT_THAT(rows.targets, IsEmpty());
  EXPECT_THAT(rows.firsts, ElementsAre(0, 1, 2, 3, 4));
}

TEST(DynamicsTest, EveryRowIsEitherATargetOrAFirst) {
  for (const int order : {1, 2, 5}) {
    const DynamicsRows rows = MakeDynamicsRows({0, 1, 8, 20}, 33, order);
    std::vector<int> all = rows.targets;
    all.insert(all.end(), rows.firsts.begin(), rows.firsts.end());
    std::sort(all.begin(), all.end());
    std::vector<int> expected(33);
    std::iota(expected.begin(), expected.end(), 0);
    EXPECT_EQ(all, expected) << order;
  }
}

TEST(DynamicsTest, GatherPutsTheNewestFrameFirst) {
  Eigen::MatrixXd latents(5, 2);
  latents << 0, 0.5, 1, 1.5, 2, 2.5, 3, 3.5, 4, 4.5;
  Eigen::MatrixXd inputs, outputs;
  MakeDynamicsRows({0}, 5, 2).Gather(latents, &inputs, &outputs);
  ASSERT_EQ(inputs.rows(), 3);
  EXPECT_EQ(inputs.row(0), Eigen::RowVector4d(1, 1.5, 0, 0.5));
  EXPECT_EQ(outputs.row(0), Eigen::RowVector2d(2, 2.5));
  EXPECT_EQ(inputs.row(2), Eigen::RowVector4d(3, 3.5, 2, 2.5));
  EXPECT_EQ(outputs.row(2), Eigen::RowVector2d(4, 4.5));
}

// Scatter is the transpose of Gather: <G(x), (a, b)> = <x, S(a, b)> for any x, a and b. Then the
// gradient of everything that is computed from Gather's results is right.
TEST(DynamicsTest, ScatterIsTheTransposeOfGather) {
  for (const int order : {1, 2, 3}) {
    const DynamicsRows rows = MakeDynamicsRows({0, 6, 8}, 15, order);
    const Eigen::MatrixXd latents = RandomMatrix(15, 3, 1);
    Eigen::MatrixXd inputs, outputs;
    rows.Gather(latents, &inputs, &outputs);
    const Eigen::MatrixXd a = RandomMatrix(static_cast<int>(inputs.rows()), 3 * order, 2);
    const Eigen::MatrixXd b = RandomMatrix(static_cast<int>(outputs.rows()), 3, 3);
    Eigen::MatrixXd gradient = RandomMatrix(15, 3, 4);
    const Eigen::MatrixXd before = gradient;
    rows.Scatter(a, b, 1.7, &gradient);  // adds
    const double expected = 1.7 * (inputs.cwiseProduct(a).sum() + outputs.cwiseProduct(b).sum());
    EXPECT_NEAR(latents.cwiseProduct(gradient - before).sum(), expected, 1e-10) << order;
  }
}

}  // namespace
}  // namespace pleat
