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

// A linear function of one unknown that claims the slope `claimed`.
class Claimed : public Objective {
 public:
  Claimed(double slope, double claimed) : slope_(slope), claimed_(claimed) {}
  int num_unknowns() const override { return 1; }
  double Evaluate(const Eigen::VectorXd& x, Eigen::VectorXd* gradient) override {
    if (gradient) gradient->setConstant(1, claimed_);
    return slope_ * x[0];
  }

 private:
  double slope_, claimed_;
};

TEST(CheckGradientTest, AForgottenGradientIsFoundAtAnyScale) {
  for (const double slope : {1e6, 1.0, 1e-6}) {
    for (const double at : {0.0, 1e8, -1e-8}) {
      const Eigen::VectorXd x = Eigen::VectorXd::Constant(1, at);
      Claimed right(slope, slope), doubled(slope, 2 * slope);
      EXPECT_LT(CheckGradient(right, x).max_relative_error, 1e-6) << slope << " at " << at;
      EXPECT_NEAR(CheckGradient(doubled, x).max_relative_error, .5, 1e-6) << slope << " at " << at;
    }
  }
  // Where all that is claimed is zero, errors are absolute below 1.
  const Eigen::VectorXd x = Eigen::VectorXd::Zero(1);
  Claimed zero(0, 0), forgotten(3, 0), tiny(1e-3, 0);
  EXPECT_EQ(CheckGradient(zero, x).max_relative_error, 0);
  EXPECT_NEAR(CheckGradient(forgotten, x).max_relative_error, 1, 1e-9);
  EXPECT_NEAR(CheckGradient(tiny, x).max_relative_error, 1e-3, 1e-9);
}

TEST(CheckGradientTest, NoUnknownsHaveNoError) {
  Rosenbrock nothing(0);
  const GradientCheck check = CheckGradient(nothing, Eigen::VectorXd(0));
  EXPECT_EQ(check.max_relative_error, 0);
  EXPECT_EQ(check.worst_unknown, -1);
}

TEST(CheckGradientTest, NotANumberIsTheWorstError) {
  LogBarrier objective;
  Eigen::VectorXd x = Eigen::VectorXd::Constant(1, -1.0);
  EXPECT_FALSE(CheckGradient(objective, x).max_relative_error < 1e9);
}

}  // namespace
}  // namespace pleat
