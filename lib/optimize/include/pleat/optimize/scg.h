// Scaled conjugate gradients, the optimizer of the paper (section IV-B).
// Source: M. F. Moller, "A scaled conjugate gradient algorithm for fast supervised learning",
// Neural Networks 6 (1993).
#pragma once

#include <Eigen/Core>

#include "absl/status/statusor.h"
#include "pleat/base/progress.h"
#include "pleat/optimize/objective.h"
#include "pleat/optimize/summary.h"

namespace pleat {

// Says what the curvature along a direction is estimated from.
enum class ScgCurvature {
  kGradients,  // the difference of two gradients: Moller's way
  // The second difference of two values and a slope, for objectives whose value costs much less
  // than a gradient. Rounding weighs with 1 / step^2 here, so the step is ten times as long.
  // Differences that drown in rounding all the same are left to the gradients.
  kValues,
};

struct ScgOptions {
  int max_iterations = 100;        // attempted steps; the paper's value
  double gradient_tolerance = 0;   // stop when no gradient entry is larger; 0: run all iterations
  double objective_tolerance = 0;  // stop when a step gains less than this share of |objective|
  double sigma0 = 1e-4;            // length of the finite difference that probes the curvature
  ScgCurvature curvature = ScgCurvature::kGradients;
  double initial_lambda = 1;  // scale of the trust region; adapted at every step
  double min_lambda = 1e-15, max_lambda = 1e100;
};

// Minimizes `objective` from `start` and returns the best point found, at about 1.9 evaluations per
// iteration. The error is kInvalidArgument when the objective or its gradient is not finite at the
// start or `start` has the wrong size, and kCancelled. `summary` may be null. See
// docs/method/learner.md#scg.
absl::StatusOr<Eigen::VectorXd> MinimizeScg(Objective& objective, const Eigen::VectorXd& start,
                                            const ScgOptions& options = {},
                                            OptimizationSummary* summary = nullptr,
                                            const Progress& progress = {});

}  // namespace pleat
