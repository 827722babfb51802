#include "pleat/optimize/objective.h"

#include <algorithm>
#include <cmath>

namespace pleat {

GradientCheck CheckGradient(Objective& objective, const Eigen::VectorXd& x, double step) {
  Eigen::VectorXd gradient(x.size());
  objective.Evaluate(x, &gradient);
  const double largest = gradient.size() ? gradient.cwiseAbs().maxCoeff() : 0;
  const double scale = largest > 0 ? 1e-3 * largest : 1;
  GradientCheck check;
  Eigen::VectorXd probe = x;
  for (Eigen::Index i = 0; i < x.size(); ++i) {
    const double h = step * std::max(1.0, std::abs(x[i]));
    probe[i] = x[i] + h;
    const double above = objective.Evaluate(probe, nullptr);
    probe[i] = x[i] - h;
    const double below = objective.Evaluate(probe, nullptr);
    probe[i] = x[i];
    const double numeric = (above - below) / (2 * h);
    const double error = std::abs(gradient[i] - numeric) /
                         std::max({std::abs(gradient[i]), std::abs(numeric), scale});
    // The comparison is written so that a NaN counts as the worst error.
    if (check.worst_unknown < 0 || !(error <= check.max_relative_error)) {
      check = {error, static_cast<int>(i), gradient[i], numeric};
    }
  }
  return check;
}

}  // namespace pleat
