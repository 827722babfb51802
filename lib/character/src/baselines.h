// The baselines, which a learner must beat on held-out motion
// (docs/method/evaluation.md#baselines).
#pragma once

#include <Eigen/Core>
#include <functional>
#include <map>
#include <string>

#include "absl/status/statusor.h"
#include "training_steps.h"

namespace pleat {

// Turns a feature row (D_S) into the details of the control vertices (3C, meters).
using DetailPredictor = std::function<Eigen::VectorXd(const Eigen::VectorXd& features)>;

// Trains the baselines on `data`, which must outlive them: "zero" (no detail), "mean" (the mean of
// the training details), "nearest" (the details of the training frame with the nearest features)
// and "ridge" (linear regression).
absl::StatusOr<std::map<std::string, DetailPredictor>> TrainBaselines(const LearningData& data);

}  // namespace pleat
