// What both optimizers promise, whatever way they take.
#include <gtest/gtest.h>

#include <Eigen/QR>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "pleat/base/random.h"
#include "pleat/optimize/lbfgs.h"
#include "pleat/optimize/scg.h"
#include "support/status_matchers.h"
#include "test_objectives.h"

namespace pleat {
namespace {

using ::testing::HasSubstr;

// What both sets of options have in common.
struct Limits {
  int max_iterations = 100;
  double gradient_tolerance = 0, objective_tolerance = 0;
};

enum class Method { kLbfgs, kScg, kScgWithValues };

class OptimizersTest : public testing::TestWithParam<Method> {
 protected:
  static absl::StatusOr<Eigen::VectorXd> Minimize(Objective& objective,
                                                  const Eigen::VectorXd& start,
                                                  const Limits& limits = {},
                                                  OptimizationSummary* summary = nullptr,
                                                  const Progress& progress = {}) {
    if (GetParam() == Method::kLbfgs) {
      const LbfgsOptions options{.max_iterations = limits.max_iterations,
                                 .gradient_tolerance = limits.gradient_tolerance,
                                 .objective_tolerance = limits.objective_tolerance};
      return MinimizeLbfgs(objective, start, options, summary, progress);
    }
    const bool values = GetParam() == Method::kScgWithValues;
    const ScgOptions options{
        .max_iterations = limits.max_iterations,
        .gradient_tolerance = limits.gradient_tolerance,
        .objective_tolerance = limits.objective_tolerance,
        .curvature = values ? ScgCurvature::kValues : ScgCurvature::kGradients};
    return MinimizeScg(objective, start, options, summary, progress);
  }
};

std::string NameOf(const testing::TestParamInfo<Method>& info) {
  if (info.param == Method::kLbfgs) return "Lbfgs";
  return info.param == Method::kScg ? "Scg" : "ScgWithValues";
}

INSTANTIATE_TEST_SUITE_P(Methods, OptimizersTest,
                         testing::Values(Method::kLbfgs, Method::kScg, Method::kScgWithValues),
                         NameOf);

// 1/2 (x - m)^T Q diag(c) Q^T (x - m), with eigenvalues from 1 to `condition` along random axes.
class TurnedQuadratic : public Objective {
 public:
  TurnedQuadratic(int num_unknowns, double condition) : minimum_(num_unknowns) {
    Random random(7);
    Eigen::MatrixXd axes(num_unknowns, num_unknowns);
    for (double& entry : axes.reshaped()) entry = random.Normal();
    for (double& entry : minimum_) entry = random.Normal();
    const Eigen::MatrixXd q = Eigen::HouseholderQR<Eigen::MatrixXd>(axes).householderQ();
    Eigen::VectorXd values(num_unknowns);
    for (int i = 0; i < num_unknowns; ++i) {
      values[i] = std::pow(condition, static_cast<double>(i) / (num_unknowns - 1));
    }
    hessian_ = q * values.asDiagonal() * q.transpose();
  }
  int num_unknowns() const override { return static_cast<int>(minimum_.size()); }
  double Evaluate(const Eigen::VectorXd& x, Eigen::VectorXd* gradient) override {
    const Eigen::VectorXd slope = hessian_ * (x - minimum_);
    if (gradient) *gradient = slope;
    return .5 * slope.dot(x - minimum_);
  }
  const Eigen::VectorXd& minimum() const { return minimum_; }

 private:
  Eigen::VectorXd minimum_;
  Eigen::MatrixXd hessian_;
};

TEST_P(OptimizersTest, SolvesQuadraticsOfAnyCondition) {
  for (const double condition : {1.0, 1e2, 1e6}) {
    TurnedQuadratic objective(6, condition);
    OptimizationSummary summary;
    PLEAT_ASSERT_OK_AND_ASSIGN(
        const Eigen::VectorXd x,
        Minimize(objective, Eigen::VectorXd::Zero(6),
                 {.max_iterations = 5000, .gradient_tolerance = 1e-6}, &summary));
    EXPECT_EQ(summary.stop_reason, StopReason::kGradientTolerance) << condition;
    EXPECT_LE(summary.final_gradient, 1e-6);
    EXPECT_LT((x - objective.minimum()).norm(), 1e-5) << condition;
  }
}

TEST_P(OptimizersTest, FindsTheEndOfTheValleyFromEverySide) {
  for (const Eigen::Vector2d& start :
       {Eigen::Vector2d(-1.2, 1), Eigen::Vector2d(3, -4), Eigen::Vector2d(0, 0),
        Eigen::Vector2d(-20, 5), Eigen::Vector2d(1, 1.5)}) {
    Rosenbrock objective(2);
    PLEAT_ASSERT_OK_AND_ASSIGN(
        const Eigen::VectorXd x,
        Minimize(objective, start, {.max_iterations = 5000, .gradient_tolerance = 1e-7}));
    EXPECT_LT((x - Eigen::Vector2d(1, 1)).norm(), 1e-4) << start.transpose();
  }
}

// Runs of rising budgets are prefixes of one path, so the best point so far must only fall.
TEST_P(OptimizersTest, EveryBudgetReturnsTheLowestPointSoFarAndReportsIt) {
  Rosenbrock objective(5);
  const Eigen::VectorXd start = Eigen::VectorXd::LinSpaced(5, -2, 1.5);
  double last = objective.Evaluate(start, nullptr);
  for (int budget = 0; budget <= 40; ++budget) {
    OptimizationSummary summary;
    PLEAT_ASSERT_OK_AND_ASSIGN(const Eigen::VectorXd x,
                               Minimize(objective, start, {.max_iterations = budget}, &summary));
    EXPECT_EQ(summary.iterations, budget);
    EXPECT_EQ(summary.stop_reason, StopReason::kMaxIterations);
    EXPECT_LE(summary.final_objective, last) << budget;
    last = summary.final_objective;
    Eigen::VectorXd gradient(5);
    EXPECT_EQ(objective.Evaluate(x, &gradient), summary.final_objective);
    EXPECT_EQ(gradient.cwiseAbs().maxCoeff(), summary.final_gradient);
    if (budget == 0) {
      EXPECT_EQ(x, start);
    }
  }
  EXPECT_LT(last, 10);
}

TEST_P(OptimizersTest, TheSameRunGivesTheSameBits) {
  Rosenbrock objective(7);
  const Eigen::VectorXd start = Eigen::VectorXd::LinSpaced(7, -1, 2);
  EXPECT_EQ(*Minimize(objective, start), *Minimize(objective, start));
}

TEST_P(OptimizersTest, CountsAndReportsWhatItDoes) {
  // Counts every call.
  class Counting : public Rosenbrock {
   public:
    using Rosenbrock::Rosenbrock;
    double Evaluate(const Eigen::VectorXd& x, Eigen::VectorXd* gradient) override {
      ++num_calls;
      return Rosenbrock::Evaluate(x, gradient);
    }
    int num_calls = 0;
  };
  Counting objective(4);
  std::vector<double> fractions, objectives;
  const Progress progress(
      [&](const ProgressUpdate& update) {
        fractions.push_back(update.fraction);
        objectives.push_back(*update.objective);
      },
      nullptr);
  OptimizationSummary summary;
  ASSERT_THAT(
      Minimize(objective, Eigen::VectorXd::Zero(4), {.max_iterations = 25}, &summary, progress),
      IsOk());
  EXPECT_EQ(summary.evaluations, objective.num_calls);
  ASSERT_EQ(fractions.size(), 25u);
  for (size_t i = 0; i < fractions.size(); ++i) {
    EXPECT_DOUBLE_EQ(fractions[i], static_cast<double>(i + 1) / 25);
    if (i > 0) {
      EXPECT_LE(objectives[i], objectives[i - 1]);
    }
  }
}

// x - log x with a wall at 0: outside, value and gradient are what the test wants.
class Walled : public LogBarrier {
 public:
  explicit Walled(double outside) : outside_(outside) {}
  double Evaluate(const Eigen::VectorXd& x, Eigen::VectorXd* gradient) override {
    if (x[0] > 0) return LogBarrier::Evaluate(x, gradient);
    if (gradient) gradient->setConstant(1, outside_);
    return outside_;
  }

 private:
  double outside_;
};

// A value of minus infinity is no minimum.
TEST_P(OptimizersTest, ValuesThatAreNotFiniteAreOutsideOfTheDomain) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  for (const double outside : {std::nan(""), kInfinity, -kInfinity}) {
    for (const double start : {1e-3, .5, 40.0}) {
      Walled objective(outside);
      PLEAT_ASSERT_OK_AND_ASSIGN(const Eigen::VectorXd x,
                                 Minimize(objective, Eigen::VectorXd::Constant(1, start),
                                          {.max_iterations = 400, .gradient_tolerance = 1e-6}));
      EXPECT_NEAR(x[0], 1, 1e-4) << outside << " from " << start;
    }
    Walled objective(outside);
    EXPECT_THAT(Minimize(objective, Eigen::VectorXd::Constant(1, -1.0)),
                HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("starting point")));
  }
}

TEST_P(OptimizersTest, AGradientThatPointsTheWrongWayMovesNothing) {
  class Uphill : public Quadratic {
   public:
    using Quadratic::Quadratic;
    double Evaluate(const Eigen::VectorXd& x, Eigen::VectorXd* gradient) override {
      const double value = Quadratic::Evaluate(x, gradient);
      if (gradient) *gradient *= -1;
      return value;
    }
  };
  Uphill objective(3);
  const Eigen::VectorXd start = Eigen::VectorXd::Constant(3, 10.0);
  OptimizationSummary summary;
  PLEAT_ASSERT_OK_AND_ASSIGN(const Eigen::VectorXd x,
                             Minimize(objective, start, {.max_iterations = 10000}, &summary));
  EXPECT_EQ(summary.stop_reason, StopReason::kNoProgress);
  EXPECT_EQ(summary.final_objective, summary.initial_objective);
  EXPECT_LT((x - start).norm(), 1e-6);
}

TEST_P(OptimizersTest, StopsOnceAStepGainsLittle) {
  class Raised : public Rosenbrock {  // the tolerance is a share of the value, here 1 at the end
   public:
    using Rosenbrock::Rosenbrock;
    double Evaluate(const Eigen::VectorXd& x, Eigen::VectorXd* gradient) override {
      return 1 + Rosenbrock::Evaluate(x, gradient);
    }
  };
  Raised objective(6);
  OptimizationSummary coarse, fine;
  const Eigen::VectorXd start = Eigen::VectorXd::Constant(6, 3.0);
  ASSERT_THAT(
      Minimize(objective, start, {.max_iterations = 5000, .objective_tolerance = 1e-1}, &coarse),
      IsOk());
  ASSERT_THAT(
      Minimize(objective, start, {.max_iterations = 5000, .objective_tolerance = 1e-4}, &fine),
      IsOk());
  EXPECT_EQ(coarse.stop_reason, StopReason::kObjectiveTolerance);
  EXPECT_EQ(fine.stop_reason, StopReason::kObjectiveTolerance);
  EXPECT_LE(coarse.iterations, fine.iterations);
  EXPECT_LE(fine.final_objective, coarse.final_objective);
}

TEST_P(OptimizersTest, NothingToMinimizeIsDoneAtOnce) {
  Quadratic nothing(0);
  OptimizationSummary summary;
  PLEAT_ASSERT_OK_AND_ASSIGN(const Eigen::VectorXd x,
                             Minimize(nothing, Eigen::VectorXd(0), {}, &summary));
  EXPECT_EQ(x.size(), 0);
  EXPECT_EQ(summary.iterations, 0);
  EXPECT_EQ(summary.stop_reason, StopReason::kGradientTolerance);
}

// An objective that hears of the cancellation returns NaN, at the start and on the way. The caller
// must be told of the cancellation, not of the NaN.
TEST_P(OptimizersTest, ACancelledObjectiveIsNotTakenForABadOne) {
  class Cancellable : public Rosenbrock {
   public:
    explicit Cancellable(int allowed) : Rosenbrock(4), allowed_(allowed) {}
    double Evaluate(const Eigen::VectorXd& x, Eigen::VectorXd* gradient) override {
      const double value = Rosenbrock::Evaluate(x, gradient);
      cancelled |= --allowed_ < 0;
      return cancelled ? std::nan("") : value;
    }
    bool cancelled = false;

   private:
    int allowed_;
  };
  for (const int allowed : {0, 1, 2, 3, 10, 17}) {
    Cancellable objective(allowed);
    const Progress progress(nullptr, [&] { return objective.cancelled; });
    EXPECT_THAT(Minimize(objective, Eigen::VectorXd::Zero(4), {}, nullptr, progress),
                HasStatus(absl::StatusCode::kCancelled, testing::_))
        << allowed;
  }
}

}  // namespace
}  // namespace pleat
