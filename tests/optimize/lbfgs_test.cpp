#include "pleat/optimize/lbfgs.h"

#include <gtest/gtest.h>

#include "pleat/optimize/scg.h"
#include "support/status_matchers.h"
#include "test_objectives.h"

namespace pleat {
namespace {

using ::testing::HasSubstr;

TEST(LbfgsTest, SolvesABadlyScaledQuadratic) {
  Quadratic objective(30);
  OptimizationSummary summary;
  PLEAT_ASSERT_OK_AND_ASSIGN(
      const Eigen::VectorXd x,
      MinimizeLbfgs(objective, Eigen::VectorXd::Zero(30),
                    {.max_iterations = 1000, .gradient_tolerance = 1e-7}, &summary));
  for (int i = 0; i < 30; ++i) EXPECT_NEAR(x[i], i, 1e-6);
  EXPECT_EQ(summary.stop_reason, StopReason::kGradientTolerance);
}

TEST(LbfgsTest, FindsTheMinimumOfACurvedValleyInFewerEvaluationsThanScg) {
  Rosenbrock objective(2);
  Eigen::VectorXd start(2);
  start << -1.2, 1;
  OptimizationSummary lbfgs, scg;
  PLEAT_ASSERT_OK_AND_ASSIGN(const Eigen::VectorXd x,
                             MinimizeLbfgs(objective, start, {.gradient_tolerance = 1e-8}, &lbfgs));
  EXPECT_NEAR(x[0], 1, 1e-7);
  EXPECT_NEAR(x[1], 1, 1e-7);
  EXPECT_LT(lbfgs.evaluations, 80);
  PLEAT_ASSERT_OK_AND_ASSIGN(
      const Eigen::VectorXd y,
      MinimizeScg(objective, start, {.max_iterations = 1000, .gradient_tolerance = 1e-8}, &scg));
  EXPECT_LT(lbfgs.evaluations, scg.evaluations);
  EXPECT_EQ(y.size(), 2);
}

TEST(LbfgsTest, ReturnsThePointOfTheReportedValue) {
  Rosenbrock objective(8);
  OptimizationSummary summary;
  PLEAT_ASSERT_OK_AND_ASSIGN(const Eigen::VectorXd x,
                             MinimizeLbfgs(objective, Eigen::VectorXd::Constant(8, -2.0),
                                           {.max_iterations = 15}, &summary));
  EXPECT_DOUBLE_EQ(objective.Evaluate(x, nullptr), summary.final_objective);
  EXPECT_EQ(summary.stop_reason, StopReason::kMaxIterations);
}

TEST(LbfgsTest, KeepsToItsBudgetOfEvaluations) {
  Rosenbrock objective(20);
  OptimizationSummary summary;
  PLEAT_ASSERT_OK_AND_ASSIGN(
      const Eigen::VectorXd x,
      MinimizeLbfgs(objective, Eigen::VectorXd::Constant(20, 3.0),
                    {.max_iterations = 1000, .max_evaluations = 30}, &summary));
  EXPECT_LE(summary.evaluations, 30 + 21);
  EXPECT_EQ(x.size(), 20);
}

TEST(LbfgsTest, StaysInsideTheDomain) {
  LogBarrier objective;
  PLEAT_ASSERT_OK_AND_ASSIGN(
      const Eigen::VectorXd x,
      MinimizeLbfgs(objective, Eigen::VectorXd::Constant(1, 5.0), {.gradient_tolerance = 1e-9}));
  EXPECT_NEAR(x[0], 1, 1e-8);
}

TEST(LbfgsTest, StopsWhereNoDescentIsPossible) {
  Quadratic objective(3);
  Eigen::VectorXd minimum(3);
  minimum << 0, 1, 2;
  OptimizationSummary summary;
  PLEAT_ASSERT_OK_AND_ASSIGN(const Eigen::VectorXd x,
                             MinimizeLbfgs(objective, minimum, {}, &summary));
  EXPECT_EQ(summary.iterations, 0);
  EXPECT_EQ((x - minimum).norm(), 0);
}

// A direction from few pairs is worse, but the line search makes every one of them work.
TEST(LbfgsTest, AShortMemoryCostsIterationsOnly) {
  Rosenbrock objective(2);
  int last = 1 << 30;
  for (const int history : {0, 1, 8}) {
    OptimizationSummary summary;
    PLEAT_ASSERT_OK_AND_ASSIGN(
        const Eigen::VectorXd x,
        MinimizeLbfgs(objective, Eigen::Vector2d(-1.2, 1),
                      {.max_iterations = 50000, .gradient_tolerance = 1e-5, .history = history},
                      &summary));
    EXPECT_LT((x - Eigen::Vector2d(1, 1)).norm(), 1e-3) << history;
    EXPECT_LT(summary.iterations, last) << history;
    last = summary.iterations;
  }
}

TEST(LbfgsTest, ALineSearchEndsAtItsOwnBudget) {
  Rosenbrock objective(4);
  for (const int budget : {1, 2, 5}) {
    OptimizationSummary summary;
    PLEAT_ASSERT_OK_AND_ASSIGN(
        const Eigen::VectorXd x,
        MinimizeLbfgs(objective, Eigen::VectorXd::Constant(4, -1.0),
                      {.max_iterations = 30, .max_line_search_evaluations = budget}, &summary));
    // One more when the best point of the search has to be looked at again.
    EXPECT_LE(summary.evaluations, 1 + summary.iterations * (budget + 1)) << budget;
    EXPECT_LE(summary.final_objective, summary.initial_objective);
    EXPECT_EQ(objective.Evaluate(x, nullptr), summary.final_objective);
  }
}

TEST(LbfgsTest, StopsWhenCancelled) {
  Rosenbrock objective(4);
  bool cancelled = false;
  const Progress progress([&](const ProgressUpdate& update) { cancelled = update.fraction > .05; },
                          [&] { return cancelled; });
  EXPECT_THAT(MinimizeLbfgs(objective, Eigen::VectorXd::Zero(4), {}, nullptr, progress),
              HasStatus(absl::StatusCode::kCancelled, HasSubstr("cancelled")));
}

}  // namespace
}  // namespace pleat
