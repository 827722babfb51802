#include "pleat/learner/ridge.h"

#include <gtest/gtest.h>

#include <cmath>

#include "support/gp_predictions.h"
#include "support/random_data.h"
#include "support/status_matchers.h"

namespace pleat {
namespace {

using ::testing::HasSubstr;

TEST(RidgeTest, FindsALinearMapWithItsOffset) {
  const Eigen::MatrixXd x = RandomMatrix(50, 4, 1), map = RandomMatrix(4, 3, 2);
  Eigen::MatrixXd y = x * map;
  y.rowwise() += Eigen::RowVector3d(5, -2, .5);
  PLEAT_ASSERT_OK_AND_ASSIGN(const Ridge ridge, TrainRidge(x, y, {.penalty = 1e-10}));
  EXPECT_LT((ridge.Predict(x) - y).norm(), 1e-6);
  EXPECT_LT((ridge.weights - map).norm(), 1e-6);
}

TEST(RidgeTest, WideAndTallDataAgree) {
  // The same regression with as many columns as rows, once through each normal equation.
  const Eigen::MatrixXd x = RandomMatrix(20, 20, 1), y = RandomMatrix(20, 2, 2);
  Eigen::MatrixXd padded(20, 21);
  padded << x, Eigen::VectorXd::Zero(20);
  PLEAT_ASSERT_OK_AND_ASSIGN(const Ridge tall, TrainRidge(x, y));
  PLEAT_ASSERT_OK_AND_ASSIGN(const Ridge wide, TrainRidge(padded, y));
  EXPECT_LT((tall.weights - wide.weights.topRows(20)).norm(), 1e-8);
}

TEST(RidgeTest, HeavierPenaltyShrinksTheWeights) {
  const Eigen::MatrixXd x = RandomMatrix(30, 5, 1), y = RandomMatrix(30, 2, 2);
  PLEAT_ASSERT_OK_AND_ASSIGN(const Ridge light, TrainRidge(x, y, {.penalty = 1e-6}));
  PLEAT_ASSERT_OK_AND_ASSIGN(const Ridge heavy, TrainRidge(x, y, {.penalty = 10}));
  EXPECT_LT(heavy.weights.norm(), .1 * light.weights.norm());
}

TEST(RidgeTest, AsAGaussianProcessItPredictsTheSameAndKnowsItsVariance) {
  for (const int num_inputs : {4, 30}) {  // fewer and more than rows
    const Eigen::MatrixXd x = RandomMatrix(20, num_inputs, 1), y = RandomMatrix(20, 3, 2);
    const Eigen::MatrixXd queries = 2 * RandomMatrix(5, num_inputs, 3);
    for (const double penalty : {1e-3, 1e-1}) {
      PLEAT_ASSERT_OK_AND_ASSIGN(const Ridge ridge, TrainRidge(x, y, {.penalty = penalty}));
      PLEAT_ASSERT_OK_AND_ASSIGN(const GpRegression gp, TrainRidgeGp(x, y, {.penalty = penalty}));
      const Eigen::MatrixXd means = PredictRows(gp, queries).means;
      EXPECT_LT((means - ridge.Predict(queries)).norm(), 1e-4 * means.norm());
      // The variance of a linear map grows with the square of the distance from the mean.
      Eigen::MatrixXd ray(2, num_inputs);
      ray.row(0) = x.colwise().mean() + queries.row(0);
      ray.row(1) = x.colwise().mean() + 2 * queries.row(0);
      const Eigen::VectorXd variances = PredictRows(gp, ray).variances;
      EXPECT_GT(variances[0], 0);
      EXPECT_NEAR(variances[1], 4 * variances[0], 1e-2 * variances[1]);
    }
  }
}

// The weights are where the gradient of |y - x w|^2 + penalty |x|^2 |w|^2 vanishes.
TEST(RidgeTest, WeightsSolveTheirNormalEquations) {
  for (const int num_inputs : {3, 40}) {
    const Eigen::MatrixXd inputs = RandomMatrix(15, num_inputs, 1).array() + 4;
    const Eigen::MatrixXd outputs = RandomMatrix(15, 2, 2).array() - 9;
    PLEAT_ASSERT_OK_AND_ASSIGN(const Ridge ridge, TrainRidge(inputs, outputs, {.penalty = .01}));
    const Eigen::MatrixXd x = inputs.rowwise() - inputs.colwise().mean();
    const Eigen::MatrixXd y = outputs.rowwise() - outputs.colwise().mean();
    const Eigen::MatrixXd slope =
        x.transpose() * (x * ridge.weights - y) + .01 * x.squaredNorm() * ridge.weights;
    EXPECT_LT(slope.cwiseAbs().maxCoeff(), 1e-9);
    EXPECT_LT((ridge.Predict(inputs.colwise().mean()) - outputs.colwise().mean()).norm(), 1e-9);
  }
}

TEST(RidgeTest, InputsThatNeverChangePredictTheMean) {
  const Eigen::MatrixXd y = RandomMatrix(6, 2, 2);
  for (const int num_rows : {1, 6}) {
    const Eigen::MatrixXd x = Eigen::MatrixXd::Constant(num_rows, 3, 5);
    PLEAT_ASSERT_OK_AND_ASSIGN(const Ridge ridge, TrainRidge(x, y.topRows(num_rows)));
    PLEAT_ASSERT_OK_AND_ASSIGN(const GpRegression gp, TrainRidgeGp(x, y.topRows(num_rows)));
    const Eigen::RowVectorXd mean = y.topRows(num_rows).colwise().mean();
    EXPECT_LT((ridge.Predict(x.topRows(1)) - mean).norm(), 1e-9);
    EXPECT_LT((PredictRows(gp, x.topRows(1)).means - mean).norm(), 1e-9);
  }
}

TEST(RidgeTest, RefusesWrongDataWithWords) {
  const Eigen::MatrixXd x = RandomMatrix(10, 2, 1);
  EXPECT_THAT(TrainRidgeGp(RandomMatrix(5, 2, 1), RandomMatrix(4, 2, 2)),
              HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("as many rows")));
  EXPECT_THAT(TrainRidge(x, x.topRows(3)),
              HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("as many rows")));
  EXPECT_THAT(TrainRidge(x, x, {.penalty = 0}),
              HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("positive penalty")));
  Eigen::MatrixXd hole = x;
  hole(3, 1) = std::nan("");
  EXPECT_FALSE(TrainRidge(hole, x).ok());
  EXPECT_FALSE(TrainRidgeGp(x, hole).ok());
  EXPECT_FALSE(TrainRidge(x, x, {.penalty = std::nan("")}).ok());
  EXPECT_FALSE(TrainRidge(x.leftCols(0), x).ok());
}

}  // namespace
}  // namespace pleat
