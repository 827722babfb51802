#include "baselines.h"

#include "pleat/base/status.h"
#include "pleat/gp/nearest.h"
#include "pleat/gp/ridge.h"
#include "pleat/math/pca.h"

namespace pleat {

absl::StatusOr<std::map<std::string, DetailPredictor>> TrainBaselines(const LearningData& data) {
  std::map<std::string, DetailPredictor> baselines;
  baselines["zero"] = [num_outputs = data.details.cols()](const Eigen::VectorXd&) {
    return Eigen::VectorXd(Eigen::VectorXd::Zero(num_outputs));
  };
  baselines["mean"] = [mean = Eigen::VectorXd(data.details.colwise().mean().transpose())](
                          const Eigen::VectorXd&) { return Eigen::VectorXd(mean); };
  baselines["nearest"] = [&data](const Eigen::VectorXd& features) {
    const int row = NearestRows(data.features, features.transpose()).front();
    return Eigen::VectorXd(data.details.row(row).transpose());
  };
  // Ridge is linear in its outputs, so it may as well predict all principal components.
  PrincipalComponents pca = ComputePca(data.details);
  PLEAT_ASSIGN_OR_RETURN(Ridge ridge, TrainRidge(data.features, pca.scores));
  baselines["ridge"] = [pca = std::move(pca),
                        ridge = std::move(ridge)](const Eigen::VectorXd& features) {
    const Eigen::VectorXd scores = ridge.Predict(features.transpose()).transpose();
    return Eigen::VectorXd(pca.mean + pca.basis * scores);
  };
  return baselines;
}

}  // namespace pleat
