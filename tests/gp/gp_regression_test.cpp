#include "pleat/gp/gp_regression.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <cmath>
#include <limits>

#include "support/allocation_counter.h"
#include "support/gp_predictions.h"
#include "support/random_data.h"
#include "support/status_matchers.h"

namespace pleat {
namespace {

using ::testing::HasSubstr;

// Two smooth outputs of two inputs.
Eigen::MatrixXd SmoothOutputs(const Eigen::MatrixXd& x) {
  Eigen::MatrixXd y(x.rows(), 2);
  y.col(0) = 3 + 2 * x.col(0).array().sin() * x.col(1).array().cos();
  y.col(1) = x.col(0).array() - .5 * x.col(1).array().square();
  return y;
}

TEST(GpRegressionTest, LearnsASmoothFunctionAndItsNoise) {
  const Eigen::MatrixXd x = RandomMatrix(150, 2, 1), x_new = .7 * RandomMatrix(100, 2, 2);
  const double noise = .05;
  const Eigen::MatrixXd y = SmoothOutputs(x) + noise * RandomMatrix(150, 2, 3);
  GpRegressionSummary summary;
  PLEAT_ASSERT_OK_AND_ASSIGN(const GpRegression gp, GpRegression::Train(x, y, {}, &summary));
  const auto [means, variances] = PredictRows(gp, x_new);
  EXPECT_LT((means - SmoothOutputs(x_new)).norm() / std::sqrt(200), .05);
  const GpRegressionParameters& p = gp.parameters();
  EXPECT_NEAR(std::exp(.5 * p.kernel.noise) * p.output_scale, noise, .01);
  EXPECT_LT(variances.maxCoeff(), .2 * gp.prior_variance());
  EXPECT_LT(summary.optimization.final_objective, summary.optimization.initial_objective);
  EXPECT_EQ(summary.num_rows, 150);
}

TEST(GpRegressionTest, IsTheTextbookFormula) {
  const Eigen::MatrixXd x = RandomMatrix(30, 3, 1), y = RandomMatrix(30, 2, 2);
  const KernelLogs logs{-.3, .2, -1, -2, -1.5};
  GpRegressionOptions options{.kernel = {.bias = true, .linear = true}, .normalize_inputs = false};
  PLEAT_ASSERT_OK_AND_ASSIGN(const GpRegression gp, GpRegression::Condition(x, y, logs, options));
  const double scale = gp.parameters().output_scale;
  const auto kernel = [&](const Eigen::RowVectorXd& a, const Eigen::RowVectorXd& b) {
    return std::exp(.2) * std::exp(-.5 * std::exp(-.3) * (a - b).squaredNorm()) + std::exp(-1) +
           std::exp(-1.5) * a.dot(b);
  };
  Eigen::MatrixXd k(30, 30);
  for (int i = 0; i < 30; ++i) {
    for (int j = 0; j < 30; ++j) k(i, j) = kernel(x.row(i), x.row(j));
  }
  k.diagonal().array() += std::exp(-2) + 1e-6 * std::exp(.2);
  const Eigen::RowVectorXd query = RandomMatrix(1, 3, 5);
  Eigen::VectorXd cross(30);
  for (int i = 0; i < 30; ++i) cross[i] = kernel(query, x.row(i));
  const Eigen::RowVectorXd mean = y.colwise().mean();
  const Eigen::MatrixXd centered = y.rowwise() - mean;
  const Eigen::VectorXd solved = k.llt().solve(cross);

  GpRegression::Workspace workspace;
  Eigen::VectorXd predicted(2);
  double variance = 0;
  gp.Predict(query.transpose(), 0, &workspace, predicted, &variance);
  EXPECT_LT((predicted.transpose() - mean - solved.transpose() * centered).norm(), 1e-9);
  EXPECT_NEAR(variance, (kernel(query, query) - cross.dot(solved)) * scale * scale, 1e-5);
}

TEST(GpRegressionTest, InputVarianceIsCarriedThroughToFirstOrder) {
  const Eigen::MatrixXd x = RandomMatrix(60, 2, 1);
  PLEAT_ASSERT_OK_AND_ASSIGN(const GpRegression gp, GpRegression::Train(x, SmoothOutputs(x)));
  GpRegression::Workspace workspace;
  const Eigen::Vector2d query(.3, -.2);
  Eigen::VectorXd mean(2), up(2), down(2);
  double certain = 0, uncertain = 0;
  gp.Predict(query, 0, &workspace, mean, &certain);
  gp.Predict(query, 1e-3, &workspace, mean, &uncertain);
  double squares = 0;  // of the Jacobian by finite differences
  for (int d = 0; d < 2; ++d) {
    const Eigen::Vector2d step = 1e-4 * Eigen::Vector2d::Unit(d);
    gp.Predict(query + step, 0, &workspace, up, nullptr);
    gp.Predict(query - step, 0, &workspace, down, nullptr);
    squares += ((up - down) / 2e-4).squaredNorm();
  }
  EXPECT_NEAR(uncertain - certain, 1e-3 * squares / 2, 1e-6 * squares);
}

TEST(GpRegressionTest, VarianceGrowsAwayFromTheData) {
  const Eigen::MatrixXd x = RandomMatrix(50, 2, 1);
  GpRegressionOptions options;
  options.kernel.linear = false;
  PLEAT_ASSERT_OK_AND_ASSIGN(const GpRegression gp,
                             GpRegression::Train(x, SmoothOutputs(x), options));
  GpRegression::Workspace workspace;
  Eigen::VectorXd mean(2);
  double last = -1;
  for (const double distance : {0., 3., 6., 100.}) {
    double variance = 0;
    gp.Predict(Eigen::Vector2d(distance, distance), 0, &workspace, mean, &variance);
    EXPECT_GE(variance, last);
    last = variance;
  }
  EXPECT_GT(last, .999 * gp.prior_variance());
}

TEST(GpRegressionTest, OrderOfOutputsDoesNotMatter) {
  const Eigen::MatrixXd x = RandomMatrix(40, 3, 1), y = RandomMatrix(40, 4, 2);
  PLEAT_ASSERT_OK_AND_ASSIGN(const GpRegression first, GpRegression::Train(x, y));
  PLEAT_ASSERT_OK_AND_ASSIGN(const GpRegression second,
                             GpRegression::Train(x, y.rowwise().reverse()));
  const Eigen::MatrixXd a = PredictRows(first, x).means, b = PredictRows(second, x).means;
  EXPECT_LT((a - b.rowwise().reverse()).norm(), 1e-4 * a.norm());
}

TEST(GpRegressionTest, ThinsRowsBeyondItsLimits) {
  const Eigen::MatrixXd x = RandomMatrix(90, 2, 1);
  GpRegressionSummary summary;
  PLEAT_ASSERT_OK_AND_ASSIGN(
      const GpRegression gp,
      GpRegression::Train(x, SmoothOutputs(x), {.max_hyperparameter_rows = 30, .max_rows = 45},
                          &summary));
  EXPECT_EQ(gp.num_rows(), 45);
  EXPECT_EQ(summary.num_rows, 45);
  EXPECT_EQ(summary.num_hyperparameter_rows, 30);
}

TEST(GpRegressionTest, SurvivesDegenerateData) {
  Eigen::MatrixXd x = RandomMatrix(20, 2, 1), y = RandomMatrix(20, 2, 2);
  x.bottomRows(10) = x.topRows(10);
  EXPECT_THAT(GpRegression::Train(x, y), IsOk());  // one input, two outputs
  EXPECT_THAT(GpRegression::Train(Eigen::MatrixXd::Ones(5, 2), y.topRows(5)), IsOk());
  EXPECT_THAT(GpRegression::Train(x.topRows(1), y.topRows(1)), IsOk());
  PLEAT_ASSERT_OK_AND_ASSIGN(const GpRegression constant,
                             GpRegression::Train(x, Eigen::MatrixXd::Constant(20, 1, 7)));
  GpRegression::Workspace workspace;
  Eigen::VectorXd mean(1);
  constant.Predict(Eigen::Vector2d(.1, .2), 0, &workspace, mean, nullptr);
  EXPECT_NEAR(mean[0], 7, 1e-9);
}

TEST(GpRegressionTest, PredictDoesNotAllocate) {
  if (NumAllocations() < 0) GTEST_SKIP() << "allocations cannot be counted in this build";
  const Eigen::MatrixXd x = RandomMatrix(200, 5, 1), y = RandomMatrix(200, 9, 2);
  PLEAT_ASSERT_OK_AND_ASSIGN(const GpRegression gp,
                             GpRegression::Train(x, y, {.max_iterations = 3}));
  GpRegression::Workspace workspace;
  Eigen::VectorXd query = Eigen::VectorXd::Constant(5, .1), mean(9);
  double variance = 0;
  gp.Predict(query, .1, &workspace, mean, &variance);
  const long before = NumAllocations();
  for (int i = 0; i < 10; ++i) gp.Predict(query, .1, &workspace, mean, &variance);
  EXPECT_EQ(NumAllocations(), before);
}

TEST(GpRegressionTest, ParametersRestoreTheSamePredictions) {
  const Eigen::MatrixXd x = RandomMatrix(40, 2, 1);
  PLEAT_ASSERT_OK_AND_ASSIGN(const GpRegression gp, GpRegression::Train(x, SmoothOutputs(x)));
  PLEAT_ASSERT_OK_AND_ASSIGN(const GpRegression restored,
                             GpRegression::FromParameters(gp.parameters()));
  const GpPredictions a = PredictRows(gp, x), b = PredictRows(restored, x);
  EXPECT_EQ((a.means - b.means).norm(), 0);
  EXPECT_EQ((a.variances - b.variances).norm(), 0);
  EXPECT_EQ(gp.prior_variance(), restored.prior_variance());
}

TEST(GpRegressionTest, RefusesHostileParameters) {
  const Eigen::MatrixXd x = RandomMatrix(10, 2, 1);
  PLEAT_ASSERT_OK_AND_ASSIGN(const GpRegression gp, GpRegression::Train(x, SmoothOutputs(x)));
  const auto refused = [&](auto change, const std::string& words) {
    GpRegressionParameters p = gp.parameters();
    change(p);
    EXPECT_THAT(GpRegression::FromParameters(p),
                HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr(words)));
  };
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  constexpr double kInf = std::numeric_limits<double>::infinity();
  refused([](auto& p) { p = {}; }, "no rows");
  refused([](auto& p) { p.inputs.resize(10, 0); }, "no rows");
  refused([](auto& p) { p.alpha.resize(9, 2); }, "alpha has 9");
  refused([](auto& p) { p.whitener.resize(10, 9); }, "whitener");
  refused([](auto& p) { p.input_mean.resize(3); }, "input mean");
  refused([](auto& p) { p.output_mean.resize(1); }, "output mean");
  refused([](auto& p) { p.inputs(3, 1) = kNan; }, "input is not finite");
  refused([](auto& p) { p.alpha(3, 1) = kInf; }, "alpha");
  refused([](auto& p) { p.whitener(3, 1) = std::numeric_limits<float>::infinity(); }, "whitener");
  refused([](auto& p) { p.input_scales[1] = 0; }, "scale");
  refused([](auto& p) { p.output_scale = kNan; }, "scale");
  refused([](auto& p) { p.kernel.noise = kNan; }, "hyperparameter");
  refused([](auto& p) { p.kernel_options.absolute_jitter = -1; }, "floor");
}

TEST(GpRegressionTest, RefusesWrongDataWithWords) {
  const Eigen::MatrixXd x = RandomMatrix(10, 2, 1), y = RandomMatrix(10, 1, 2);
  EXPECT_THAT(GpRegression::Train(x, y.topRows(9)),
              HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("as many rows")));
  EXPECT_THAT(GpRegression::Train(x.topRows(0), y.topRows(0)),
              HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("as many rows")));
  Eigen::MatrixXd hole = y;
  hole(2, 0) = std::nan("");
  EXPECT_THAT(GpRegression::Train(x, hole),
              HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("output is not finite")));
}

TEST(GpRegressionTest, StopsWhenCancelled) {
  const Eigen::MatrixXd x = RandomMatrix(50, 2, 1);
  int num_tests = 0;
  const Progress progress(nullptr, [&] { return ++num_tests > 20; });
  EXPECT_THAT(GpRegression::Train(x, SmoothOutputs(x), {}, nullptr, progress),
              HasStatus(absl::StatusCode::kCancelled, HasSubstr("cancelled")));
}

}  // namespace
}  // namespace pleat
