// Training of the regional learner: a basis for each region, Gaussian processes in these bases, and
// the basis of the parts that a query expands (docs/method/learner.md#parts).
#pragma once

#include <Eigen/Core>
#include <vector>

#include "absl/status/statusor.h"
#include "pleat/base/progress.h"
#include "pleat/learner/detail_model.h"
#include "pleat/math/pca.h"

namespace pleat {

struct RegionalTraining {
  PartedBasisParameters basis;
  std::vector<CoefficientFoldBlock> fold;
  RegionalGpParameters regional;
  // r x K: takes the scores of the details to the coefficients of `basis`, as exactly as the parts
  // can say it.
  Eigen::MatrixXd scores_to_coefficients;
};

// features: N x D; details: N scores of K components. input_scales: of the leading features, as the
// direct GP has learned them; the others keep their own. Errors are those of TrainDetailModel.
absl::StatusOr<RegionalTraining> TrainRegional(const Eigen::MatrixXd& features,
                                               const PrincipalComponents& details,
                                               const Eigen::VectorXd& input_scales,
                                               const DetailModelOptions& options,
                                               const Progress& progress);

}  // namespace pleat
