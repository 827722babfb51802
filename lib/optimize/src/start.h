// How both optimizers begin and end.
#pragma once

#include <Eigen/Core>
#include <cmath>

#include "absl/status/status.h"
#include "absl/strings/str_cat.h"
#include "pleat/base/progress.h"
#include "pleat/optimize/objective.h"
#include "pleat/optimize/summary.h"

namespace pleat {

// Evaluates `objective` at the start. The error is kInvalidArgument when nothing can be minimized
// from there. Cancellation is looked at first, since a cancelled objective returns NaN.
inline absl::Status EvaluateStart(Objective& objective, const Eigen::VectorXd& start,
                                  const Progress& progress, double* value,
                                  Eigen::VectorXd* gradient) {
  if (start.size() != objective.num_unknowns()) {
    return absl::InvalidArgumentError(absl::StrCat("the starting point has ", start.size(),
                                                   " entries, the objective ",
                                                   objective.num_unknowns(), " unknowns"));
  }
  gradient->resize(start.size());
  *value = objective.Evaluate(start, gradient);
  if (progress.cancelled()) return progress.Report(0);
  if (!std::isfinite(*value) || !gradient->allFinite()) {
    return absl::InvalidArgumentError(
        absl::StrCat("the objective is not finite at the starting point (value ", *value,
                     "): check the data for NaN and the starting values"));
  }
  return absl::OkStatus();
}

// Returns the largest absolute entry, which the tolerance of gradients is compared with.
inline double LargestEntry(const Eigen::VectorXd& v) {
  return v.size() > 0 ? v.cwiseAbs().maxCoeff() : 0;
}

// Writes down where a run has ended.
inline void ReportEnd(int evaluations, double value, const Eigen::VectorXd& gradient,
                      OptimizationSummary* summary) {
  summary->evaluations = evaluations;
  summary->final_objective = value;
  summary->final_gradient = LargestEntry(gradient);
}

}  // namespace pleat
