// What a learner must beat on held-out motion (docs/method/evaluation.md#baselines).
#pragma once

#include <Eigen/Core>
#include <functional>
#include <map>
#include <string>

#include "absl/status/statusor.h"
#include "training_steps.h"

namespace pleat {

// Feature row (D_S) -> details of the control vertices (3C), meters.
using DetailPredictor = std::function<Eigen::VectorXd(const Eigen::VectorXd& features)>;

// "zero" (no detail), "mean" (of the training details), "nearest" (details of the training frame
// with the nearest features) and "ridge" (linear regression), trained on `data`, which must
// outlive them.
absl::StatusOr<std::map<std::string, DetailPredictor>> TrainBaselines(const LearningData& data);

}  // namespace pleat
