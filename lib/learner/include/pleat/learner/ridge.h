// Ridge regression: the linear baseline of the evaluation, and a learner.
#pragma once

#include <Eigen/Core>

#include "absl/status/statusor.h"
#include "pleat/gp/gp_regression.h"

namespace pleat {

struct RidgeOptions {
  // Penalty on squared weights, as a share of the mean squared norm of the centered inputs times N.
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

// The same regression as a Gaussian process, which knows the variance of its mean: a linear kernel
// whose noise is `penalty`, both times the variance of largest marginal likelihood. Source:
// Rasmussen and Williams (2006), section 2.1. The RBF part of the kernel is at its lower clamp.
absl::StatusOr<GpRegression> TrainRidgeGp(const Eigen::Ref<const Eigen::MatrixXd>& inputs,
                                          const Eigen::Ref<const Eigen::MatrixXd>& outputs,
                                          const RidgeOptions& options = {});

}  // namespace pleat
