#include "pleat/optimize/objective.h"

#include <gtest/gtest.h>

#include "test_objectives.h"

namespace pleat {
namespace {

// A wrong gradient of the kind the public reference codes had: one unknown counted twice.
class WrongGradient : public Rosenbrock {
 public:
  using Rosenbrock::Rosenbrock;
  double Evaluate(const Eigen::VectorXd& x, Eigen::VectorXd* gradient) override {
    const double value = Rosenbrock::Evaluate(x, gradient);
    if (gradient) (*gradient)[2] *= 2;
    return value;
  }
};

TEST(CheckGradientTest, AcceptsARightGradient) {
  Rosenbrock objective(5);
  Eigen::VectorXd x(5);
  x << .3, -1.2, .7, 2, -.4;
  EXPECT_LT(CheckGradient(objective, x).max_relative_error, 1e-6);
}

TEST(CheckGradientTest, FindsAWrongGradientAndNamesTheUnknown) {
  WrongGradient objective(5);
  Eigen::VectorXd x(5);
  x << .3, -1.2, .7, 2, -.4;
  const GradientCheck check = CheckGradient(objective, x);
  EXPECT_NEAR(check.max_relative_error, .5, 1e-3);
  EXPECT_EQ(check.worst_unknown, 2);
  EXPECT_NEAR(check.analytic, 2 * check.numeric, 1e-3 * std::abs(check.analytic));
}

TEST(CheckGradientTest, NotANumberIsTheWorstError) {
  LogBarrier objective;
  Eigen::VectorXd x = Eigen::VectorXd::Constant(1, -1.0);
  EXPECT_FALSE(CheckGradient(objective, x).max_relative_error < 1e9);
}

}  // namespace
}  // namespace pleat
