// What an optimizer minimizes, and the one derivative checker for all objectives.
#pragma once

#include <Eigen/Core>

namespace pleat {

// A smooth function of n unknowns.
class Objective {
 public:
  virtual ~Objective() = default;
  virtual int num_unknowns() const = 0;
  // Returns the value at x (n) and fills `gradient` (n) when it is not null. A value that is not
  // finite tells the optimizer that x is outside of the domain; the gradient then has no meaning.
  // It is not const because implementations keep their working memory, so one objective serves one
  // thread.
  virtual double Evaluate(const Eigen::VectorXd& x, Eigen::VectorXd* gradient) = 0;
};

struct GradientCheck {
  double max_relative_error = 0;  // max_i |analytic - numeric| / max(|analytic|, |numeric|, scale)
  int worst_unknown = -1;
  double analytic = 0, numeric = 0;  // at the worst unknown
};

// Compares the gradient with central differences at x, entry by entry, with a step of `step` times
// max(1, |x_i|). `scale` is the floor of the denominator: 1e-3 of the largest gradient entry, or 1
// when that is zero. It costs 2 n values.
GradientCheck CheckGradient(Objective& objective, const Eigen::VectorXd& x, double step = 1e-5);

}  // namespace pleat
