#include "baselines.h"

#include <utility>

#include "pleat/base/status.h"
#include "pleat/learner/nearest.h"
#include "pleat/learner/ridge.h"

namespace pleat {

absl::StatusOr<std::map<std::string, DetailPredictor>> TrainBaselines(const LearningData& data) {
  std::map<std::string, DetailPredictor> baselines;
  const PrincipalComponents& details = data.details;
  const auto expand = [&data](const Eigen::VectorXd& scores) { return data.DetailOf(scores); };
  baselines["zero"] = [num_outputs = details.mean.size()](const Eigen::VectorXd&) {
    return Eigen::VectorXd(Eigen::VectorXd::Zero(num_outputs));
  };
  baselines["mean"] = [mean = expand(details.scores.colwise().mean().transpose())](
                          const Eigen::VectorXd&) { return mean; };
  baselines["nearest"] = [&data, expand](const Eigen::VectorXd& features) {
    const int row = NearestRows(data.features, features.transpose()).front();
    return expand(data.details.scores.row(row).transpose());
  };
  PLEAT_ASSIGN_OR_RETURN(Ridge ridge, TrainRidge(data.features, details.scores));
  baselines["ridge"] = [ridge = std::move(ridge), expand](const Eigen::VectorXd& features) {
    return expand(ridge.Predict(features.transpose()).transpose());
  };
  return baselines;
}

}  // namespace pleat
