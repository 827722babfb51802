// Limited-memory BFGS with a line search that meets the strong Wolfe conditions.
// Source: J. Nocedal, S. J. Wright, "Numerical Optimization", 2nd edition (2006), algorithms 7.4,
// 7.5, 3.5 and 3.6.
#pragma once

#include <Eigen/Core>

#include "absl/status/statusor.h"
#include "pleat/base/progress.h"
#include "pleat/optimize/objective.h"
#include "pleat/optimize/summary.h"

namespace pleat {

struct LbfgsOptions {
  int max_iterations = 100;
  int max_evaluations = 1 << 30;   // a budget for comparisons at equal cost
  double gradient_tolerance = 0;   // stop when no gradient entry is larger
  double objective_tolerance = 0;  // stop when a step gains less than this share of |objective|
  int history = 12;                // pairs of steps and gradient differences kept
  int max_line_search_evaluations = 20;
  double sufficient_decrease = 1e-4;  // first Wolfe constant
  double curvature = .9;              // second Wolfe constant
};

// Minimizes `objective` from `start` and returns the best point found, at about 1.1 evaluations per
// iteration. Every accepted point is lower than the one before. The errors are those of
// MinimizeScg. `summary` may be null.
absl::StatusOr<Eigen::VectorXd> MinimizeLbfgs(Objective& objective, const Eigen::VectorXd& start,
                                              const LbfgsOptions& options = {},
                                              OptimizationSummary* summary = nullptr,
                                              const Progress& progress = {});

}  // namespace pleat
