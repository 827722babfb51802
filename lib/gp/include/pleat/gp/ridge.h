// Ridge regression: the linear baseline of the evaluation.
#pragma once

#include <Eigen/Core>

#include "absl/status/statusor.h"

namespace pleat {

struct RidgeOptions {
  // Penalty on squared weights, as a share of the mean squared norm of the centred inputs times N.
  // Chosen on contiguous blocks held out of training clips (lib/gp/README.md).
  double penalty = 1e-3;
};

struct Ridge {
  Eigen::VectorXd input_mean, output_mean;  // D, r
  Eigen::MatrixXd weights;                  // D x r

  // M x D -> M x r.
  Eigen::MatrixXd Predict(const Eigen::Ref<const Eigen::MatrixXd>& rows) const;
};

// From inputs (N x D) and outputs (N x r); kInvalidArgument when sizes differ, are zero, or a value
// is not finite.
absl::StatusOr<Ridge> TrainRidge(const Eigen::Ref<const Eigen::MatrixXd>& inputs,
                                 const Eigen::Ref<const Eigen::MatrixXd>& outputs,
                                 const RidgeOptions& options = {});

}  // namespace pleat
