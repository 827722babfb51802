#include "pleat/learner/ridge.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "absl/strings/str_cat.h"
#include "pleat/gp/scaling.h"

namespace pleat {
namespace {

absl::Status CheckRidgeData(const Eigen::Ref<const Eigen::MatrixXd>& inputs,
                            const Eigen::Ref<const Eigen::MatrixXd>& outputs,
                            const RidgeOptions& options) {
  if (inputs.rows() >= 1 && inputs.cols() >= 1 && outputs.cols() >= 1 &&
      inputs.rows() == outputs.rows() && inputs.allFinite() && outputs.allFinite() &&
      options.penalty > 0) {
    return absl::OkStatus();
  }
  return absl::InvalidArgumentError(
      absl::StrCat("ridge regression of ", outputs.rows(), " x ", outputs.cols(), " outputs on ",
                   inputs.rows(), " x ", inputs.cols(),
                   " inputs: needs as many rows in both, finite values and a positive penalty"));
}

}  // namespace

Eigen::MatrixXd Ridge::Predict(const Eigen::Ref<const Eigen::MatrixXd>& rows) const {
  Eigen::MatrixXd means = (rows.rowwise() - input_mean.transpose()) * weights;
  means.rowwise() += output_mean.transpose();
  return means;
}

absl::StatusOr<Ridge> TrainRidge(const Eigen::Ref<const Eigen::MatrixXd>& inputs,
                                 const Eigen::Ref<const Eigen::MatrixXd>& outputs,
                                 const RidgeOptions& options) {
  if (absl::Status status = CheckRidgeData(inputs, outputs, options); !status.ok()) return status;
  Ridge ridge;
  ridge.input_mean = inputs.colwise().mean().transpose();
  ridge.output_mean = outputs.colwise().mean().transpose();
  const Eigen::MatrixXd x = inputs.rowwise() - ridge.input_mean.transpose();
  const Eigen::MatrixXd y = outputs.rowwise() - ridge.output_mean.transpose();
  const double energy = x.squaredNorm();
  const double penalty = energy > 0 ? options.penalty * energy : 1;
  if (x.cols() <= x.rows()) {
    Eigen::MatrixXd normal = x.transpose() * x;
    normal.diagonal().array() += penalty;
    ridge.weights = normal.llt().solve(x.transpose() * y);
  } else {
    Eigen::MatrixXd gram = x * x.transpose();
    gram.diagonal().array() += penalty;
    ridge.weights = x.transpose() * gram.llt().solve(y);
  }
  return ridge;
}

absl::StatusOr<GpRegression> TrainRidgeGp(const Eigen::Ref<const Eigen::MatrixXd>& inputs,
                                          const Eigen::Ref<const Eigen::MatrixXd>& outputs,
                                          const RidgeOptions& options) {
  if (absl::Status status = CheckRidgeData(inputs, outputs, options); !status.ok()) return status;
  const auto n = static_cast<double>(inputs.rows());
  Eigen::MatrixXd x = inputs.rowwise() - inputs.colwise().mean();
  const Eigen::MatrixXd y = outputs.rowwise() - outputs.colwise().mean();
  x /= PositiveRoot(x.squaredNorm() / n);  // as Condition normalizes inputs and outputs
  const double output_scale = PositiveRoot(y.squaredNorm() / static_cast<double>(y.size()));
  Eigen::MatrixXd gram = x * x.transpose();
  const double noise = options.penalty * n;
  gram.diagonal().array() += noise;
  const Eigen::MatrixXd whitened = gram.llt().matrixL().solve(y / output_scale);
  const double variance = std::max(whitened.squaredNorm() / static_cast<double>(y.size()), 1e-4);
  const KernelLogs kernel{.amplitude = -kMaxKernelLog,
                          .noise = std::log(variance * noise),
                          .linear = std::log(variance)};
  return GpRegression::Condition(inputs, outputs, kernel,
                                 {.kernel = {.bias = false, .linear = true}});
}

}  // namespace pleat
