#include "pleat/optimize/scg.h"

#include <gtest/gtest.h>

#include "support/status_matchers.h"
#include "test_objectives.h"

namespace pleat {
namespace {

using ::testing::HasSubstr;

class ScgCurvatureTest : public ::testing::TestWithParam<ScgCurvature> {};

TEST_P(ScgCurvatureTest, SolvesABadlyScaledQuadratic) {
  Quadratic objective(30);
  OptimizationSummary summary;
  PLEAT_ASSERT_OK_AND_ASSIGN(
      const Eigen::VectorXd x,
      MinimizeScg(objective, Eigen::VectorXd::Zero(30),
                  {.max_iterations = 2000, .gradient_tolerance = 1e-7, .curvature = GetParam()},
                  &summary));
  for (int i = 0; i < 30; ++i) EXPECT_NEAR(x[i], i, 1e-6);
  EXPECT_EQ(summary.stop_reason, StopReason::kGradientTolerance);
  EXPECT_LT(summary.final_objective, 1e-12);
}

TEST_P(ScgCurvatureTest, FollowsACurvedValley) {
  Rosenbrock objective(6);
  OptimizationSummary summary;
  PLEAT_ASSERT_OK_AND_ASSIGN(
      const Eigen::VectorXd x,
      MinimizeScg(objective, Eigen::VectorXd::Constant(6, -1.0),
                  {.max_iterations = 3000, .curvature = GetParam()}, &summary));
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

TEST_P(ScgCurvatureTest, StaysInsideTheDomain) {
  LogBarrier objective;
  PLEAT_ASSERT_OK_AND_ASSIGN(const Eigen::VectorXd x,
                             MinimizeScg(objective, Eigen::VectorXd::Constant(1, 1e-3),
                                         {.max_iterations = 200, .curvature = GetParam()}));
  EXPECT_NEAR(x[0], 1, 1e-4);
}

INSTANTIATE_TEST_SUITE_P(Curvatures, ScgCurvatureTest,
                         ::testing::Values(ScgCurvature::kGradients, ScgCurvature::kValues),
                         [](const auto& info) {
                           return info.param == ScgCurvature::kValues ? "Values" : "Gradients";
                         });

// Counts evaluations; `offset` is added to every value.
class Counted : public Objective {
 public:
  Counted(Objective& inner, double offset) : inner_(inner), offset_(offset) {}
  int num_unknowns() const override { return inner_.num_unknowns(); }
  double Evaluate(const Eigen::VectorXd& x, Eigen::VectorXd* gradient) override {
    ++(gradient ? num_gradients_ : num_values_);
    return inner_.Evaluate(x, gradient) + offset_;
  }
  int num_values() const { return num_values_; }
  int num_gradients() const { return num_gradients_; }

 private:
  Objective& inner_;
  double offset_;
  int num_values_ = 0, num_gradients_ = 0;
};

// The curvatures differ by the third derivative times the step: the runs stay together for a while.
TEST(ScgTest, CurvatureFromValuesSavesGradientsAndFollowsTheSamePath) {
  Rosenbrock valley(8);
  Counted from_gradients(valley, 0), from_values(valley, 0);
  const Eigen::VectorXd start = Eigen::VectorXd::Constant(8, -1.5);
  OptimizationSummary gradients, values;
  PLEAT_ASSERT_OK_AND_ASSIGN(
      const Eigen::VectorXd moller,
      MinimizeScg(from_gradients, start, {.max_iterations = 30, .sigma0 = 1e-5}, &gradients));
  PLEAT_ASSERT_OK_AND_ASSIGN(
      const Eigen::VectorXd cheap,
      MinimizeScg(from_values, start,
                  {.max_iterations = 30, .sigma0 = 1e-5, .curvature = ScgCurvature::kValues},
                  &values));
  EXPECT_LT((moller - cheap).norm(), 1e-2 * moller.norm());
  EXPECT_NEAR(values.final_objective, gradients.final_objective, 1e-3 * gradients.final_objective);
  EXPECT_EQ(from_gradients.num_values(), 0);
  EXPECT_GT(from_values.num_values(), 20);
  EXPECT_EQ(from_values.num_gradients(), 31);
  EXPECT_EQ(values.evaluations, from_values.num_values() + from_values.num_gradients());
}

// Second differences drown in the rounding of a large value: gradients take over.
TEST(ScgTest, CurvatureFromValuesSurvivesALargeValue) {
  Quadratic quadratic(5);
  Counted objective(quadratic, 1e9);
  PLEAT_ASSERT_OK_AND_ASSIGN(
      const Eigen::VectorXd x,
      MinimizeScg(objective, Eigen::VectorXd::Zero(5),
                  {.max_iterations = 300, .curvature = ScgCurvature::kValues}));
  for (int i = 0; i < 5; ++i) EXPECT_NEAR(x[i], i, 1e-2);
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
