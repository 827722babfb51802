#include "pleat/optimize/scg.h"

#include <gtest/gtest.h>

#include "support/status_matchers.h"
#include "test_objectives.h"

namespace pleat {
namespace {

using ::testing::HasSubstr;

TEST(ScgTest, SolvesABadlyScaledQuadratic) {
  Quadratic objective(30);
  OptimizationSummary summary;
  PLEAT_ASSERT_OK_AND_ASSIGN(
      const Eigen::VectorXd x,
      MinimizeScg(objective, Eigen::VectorXd::Zero(30),
                  {.max_iterations = 2000, .gradient_tolerance = 1e-7}, &summary));
  for (int i = 0; i < 30; ++i) EXPECT_NEAR(x[i], i, 1e-6);
  EXPECT_EQ(summary.stop_reason, StopReason::kGradientTolerance);
  EXPECT_LT(summary.final_objective, 1e-12);
}

TEST(ScgTest, FollowsACurvedValley) {
  Rosenbrock objective(6);
  OptimizationSummary summary;
  PLEAT_ASSERT_OK_AND_ASSIGN(const Eigen::VectorXd x,
                             MinimizeScg(objective, Eigen::VectorXd::Constant(6, -1.0),
                                         {.max_iterations = 3000}, &summary));
  // The one other stationary point of the 6-dimensional valley has value 3.97.
  EXPECT_LT(std::min(summary.final_objective, std::abs(summary.final_objective - 3.9738)), 1e-3)
      << x.transpose();
  EXPECT_GT(summary.initial_objective, 1000);
}

TEST(ScgTest, CountsAboutTwoEvaluationsPerIteration) {
  Rosenbrock objective(10);
  OptimizationSummary summary;
  PLEAT_ASSERT_OK_AND_ASSIGN(
      const Eigen::VectorXd x,
      MinimizeScg(objective, Eigen::VectorXd::Constant(10, 3.0), {.max_iterations = 50}, &summary));
  EXPECT_EQ(summary.iterations, 50);
  EXPECT_EQ(summary.stop_reason, StopReason::kMaxIterations);
  EXPECT_GT(summary.evaluations, 50);
  EXPECT_LE(summary.evaluations, 101);
  EXPECT_DOUBLE_EQ(objective.Evaluate(x, nullptr), summary.final_objective);
}

TEST(ScgTest, StaysInsideTheDomain) {
  LogBarrier objective;
  PLEAT_ASSERT_OK_AND_ASSIGN(
      const Eigen::VectorXd x,
      MinimizeScg(objective, Eigen::VectorXd::Constant(1, 1e-3), {.max_iterations = 200}));
  EXPECT_NEAR(x[0], 1, 1e-4);
}

TEST(ScgTest, StopsOnTheObjectiveTolerance) {
  LogBarrier objective;
  OptimizationSummary summary;
  PLEAT_ASSERT_OK_AND_ASSIGN(
      const Eigen::VectorXd x,
      MinimizeScg(objective, Eigen::VectorXd::Constant(1, 5.0),
                  {.max_iterations = 1000, .objective_tolerance = 1e-4}, &summary));
  EXPECT_EQ(summary.stop_reason, StopReason::kObjectiveTolerance);
  EXPECT_LT(summary.iterations, 100);
  EXPECT_NEAR(x[0], 1, .1);
}

TEST(ScgTest, RefusesAStartOutsideTheDomainOrOfWrongSize) {
  LogBarrier objective;
  EXPECT_THAT(MinimizeScg(objective, Eigen::VectorXd::Constant(1, -1.0)),
              HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("not finite")));
  EXPECT_THAT(MinimizeScg(objective, Eigen::VectorXd::Zero(2)),
              HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("2 entries")));
}

TEST(ScgTest, ReportsProgressAndStopsWhenCancelled) {
  Rosenbrock objective(4);
  int num_reports = 0;
  double last_fraction = 0;
  const Progress progress(
      [&](const ProgressUpdate& update) {
        ++num_reports;
        EXPECT_GE(update.fraction, last_fraction);
        EXPECT_TRUE(update.objective.has_value());
        last_fraction = update.fraction;
      },
      [&] { return num_reports >= 7; });
  EXPECT_THAT(MinimizeScg(objective, Eigen::VectorXd::Zero(4), {}, nullptr, progress),
              HasStatus(absl::StatusCode::kCancelled, HasSubstr("cancelled")));
  EXPECT_EQ(num_reports, 7);
}

}  // namespace
}  // namespace pleat
