// What training decides before and around the optimizer: normalization, groups, rows, refusals.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "pleat/gp/gp_regression.h"
#include "support/gp_predictions.h"
#include "support/random_data.h"
#include "support/status_matchers.h"

namespace pleat {
namespace {

using ::testing::HasSubstr;

Eigen::MatrixXd WaveOutputs(const Eigen::MatrixXd& x) {
  Eigen::MatrixXd y(x.rows(), 2);
  y.col(0) = x.col(0).array().sin();
  y.col(1) = x.col(0).array().cos() * .5;
  return y;
}

TEST(GpRegressionTrainTest, InputsAreCenteredWithUnitMeanSquaredNorm) {
  const Eigen::MatrixXd x = (100 * RandomMatrix(60, 3, 1)).array() + 1000;
  PLEAT_ASSERT_OK_AND_ASSIGN(const GpRegression gp, GpRegression::Train(x, RandomMatrix(60, 2, 2)));
  const GpRegressionParameters& p = gp.parameters();
  EXPECT_LT((p.input_mean.transpose() - x.colwise().mean()).norm(), 1e-9);
  EXPECT_NEAR(p.inputs.rowwise().squaredNorm().mean(), 1, 1e-9);
  EXPECT_LT(p.inputs.colwise().mean().norm(), 1e-9);
}

// Units do not matter: meters or millimeters in, degrees or radians out give the same function.
TEST(GpRegressionTrainTest, ScaledInputsAndOutputsGiveTheScaledFunction) {
  const Eigen::MatrixXd x = RandomMatrix(60, 2, 1), y = WaveOutputs(x);
  const Eigen::MatrixXd queries = .5 * RandomMatrix(10, 2, 3);
  PLEAT_ASSERT_OK_AND_ASSIGN(const GpRegression gp, GpRegression::Train(x, y));
  PLEAT_ASSERT_OK_AND_ASSIGN(const GpRegression scaled, GpRegression::Train(1000 * x, 7 * y));
  Eigen::MatrixXd means, scaled_means;
  Eigen::VectorXd variances, scaled_variances;
  means = PredictRows(gp, queries).means;
  variances = PredictRows(gp, queries).variances;
  scaled_means = PredictRows(scaled, 1000 * queries).means;
  scaled_variances = PredictRows(scaled, 1000 * queries).variances;
  EXPECT_LT((scaled_means / 7 - means).cwiseAbs().maxCoeff(), 1e-4);
  EXPECT_LT((scaled_variances / 49 - variances).cwiseAbs().maxCoeff(), 1e-4);
}

TEST(GpRegressionTrainTest, GroupsThatSayNothingAreTurnedDown) {
  Eigen::MatrixXd x = RandomMatrix(120, 4, 1);
  GpRegressionOptions options;
  options.input_groups = {{0, 1}, {2, 3}};  // only the first decides the outputs
  PLEAT_ASSERT_OK_AND_ASSIGN(const GpRegression gp,
                             GpRegression::Train(x, WaveOutputs(x), options));
  const Eigen::VectorXd& scales = gp.parameters().input_scales;
  EXPECT_EQ(scales[0], scales[1]);
  EXPECT_EQ(scales[2], scales[3]);
  EXPECT_GT(scales[2], 2 * scales[0]);  // divided by more: less relevant
}

TEST(GpRegressionTrainTest, GroupsMustBeDisjointColumns) {
  const Eigen::MatrixXd x = RandomMatrix(10, 3, 1);
  for (const auto& [groups, column] : {std::pair(std::vector<std::vector<int>>{{0, 3}}, 3),
                                       std::pair(std::vector<std::vector<int>>{{0, 1}, {1}}, 1),
                                       std::pair(std::vector<std::vector<int>>{{-1}}, -1)}) {
    GpRegressionOptions options;
    options.input_groups = groups;
    EXPECT_THAT(GpRegression::Train(x, x, options),
                HasStatus(absl::StatusCode::kInvalidArgument,
                          "GP regression: the groups of inputs need columns below 3, each at most "
                          "once; column " +
                              std::to_string(column) + " is not so"));
  }
}

TEST(GpRegressionTrainTest, ManyRowsAreKeptThroughAFewInducingOnes) {
  const Eigen::MatrixXd x = RandomMatrix(200, 2, 1), y = WaveOutputs(x);
  GpRegressionOptions options;
  options.max_rows = 60;
  options.max_hyperparameter_rows = 80;
  GpRegressionSummary summary;
  PLEAT_ASSERT_OK_AND_ASSIGN(const GpRegression gp, GpRegression::Train(x, y, options, &summary));
  EXPECT_EQ(summary.num_rows, 60);
  EXPECT_EQ(summary.num_hyperparameter_rows, 80);
  EXPECT_EQ(gp.num_rows(), 60);
  Eigen::MatrixXd means;
  const Eigen::MatrixXd queries = .7 * RandomMatrix(50, 2, 3);
  means = PredictRows(gp, queries).means;
  EXPECT_LT((means - WaveOutputs(queries)).cwiseAbs().maxCoeff(), .05);
}

TEST(GpRegressionTrainTest, DataThatDoNotAgreeAreToldWithTheirSizes) {
  const Eigen::MatrixXd x = RandomMatrix(10, 3, 1), y = RandomMatrix(9, 2, 2);
  EXPECT_THAT(GpRegression::Train(x, y),
              HasStatus(absl::StatusCode::kInvalidArgument,
                        HasSubstr("GP regression of 9 x 2 outputs on 10 x 3 inputs")));
  EXPECT_FALSE(GpRegression::Train(Eigen::MatrixXd(0, 3), Eigen::MatrixXd(0, 2)).ok());
  EXPECT_FALSE(GpRegression::Train(Eigen::MatrixXd(5, 0), RandomMatrix(5, 2, 1)).ok());
  Eigen::MatrixXd bad = x;
  bad(4, 1) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(GpRegression::Train(bad, x),
              HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("an input is not finite")));
  EXPECT_THAT(GpRegression::Train(x, bad),
              HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("an output is not finite")));
}

TEST(GpRegressionTrainTest, ConstantOutputsAndOneRowAreLearned) {
  PLEAT_ASSERT_OK_AND_ASSIGN(
      const GpRegression gp,
      GpRegression::Train(RandomMatrix(20, 2, 1), Eigen::MatrixXd::Constant(20, 1, 3)));
  Eigen::MatrixXd means;
  means = PredictRows(gp, RandomMatrix(5, 2, 2)).means;
  EXPECT_LT((means.array() - 3).abs().maxCoeff(), 1e-9);
  EXPECT_THAT(GpRegression::Train(RandomMatrix(1, 2, 1), RandomMatrix(1, 1, 2)), IsOk());
}

TEST(GpRegressionTrainTest, CancellationIsHeard) {
  const Eigen::MatrixXd x = RandomMatrix(60, 2, 1);
  EXPECT_THAT(
      GpRegression::Train(x, WaveOutputs(x), {}, nullptr, Progress(nullptr, [] { return true; })),
      HasStatus(absl::StatusCode::kCancelled, testing::_));
}

}  // namespace
}  // namespace pleat
