// What an optimizer minimizes, and the one derivative checker for all objectives.
#pragma once

#include <Eigen/Core>

namespace pleat {

// A smooth function of n unknowns.
class Objective {
 public:
  virtual ~Objective() = default;
  virtual int num_unknowns() const = 0;
  // The value at x (n); fills `gradient` (n) when it is not null. A value that is not finite tells
  // the optimizer that x is outside the domain.
  virtual double Evaluate(const Eigen::VectorXd& x, Eigen::VectorXd* gradient) = 0;
};

struct GradientCheck {
  double max_relative_error = 0;  // max_i |analytic - numeric| / max(|analytic|, |numeric|, scale)
  int worst_unknown = -1;
  double analytic = 0, numeric = 0;  // at the worst unknown
};

// Compares the gradient with central differences at x. `scale` is the floor of the denominator:
// 1e-3 of the largest gradient entry unless that is zero.
GradientCheck CheckGradient(Objective& objective, const Eigen::VectorXd& x, double step = 1e-5);

}  // namespace pleat
