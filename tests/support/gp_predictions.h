// Predictions of a Gaussian process at many rows.
#pragma once

#include <Eigen/Core>

#include "pleat/gp/gp_regression.h"

namespace pleat {

struct GpPredictions {
  Eigen::MatrixXd means;      // M x r
  Eigen::VectorXd variances;  // M
};

inline GpPredictions PredictRows(const GpRegression& gp,
                                 const Eigen::Ref<const Eigen::MatrixXd>& rows) {
  GpPredictions result{Eigen::MatrixXd(rows.rows(), gp.num_outputs()),
                       Eigen::VectorXd(rows.rows())};
  GpRegression::Workspace workspace;
  Eigen::VectorXd mean(gp.num_outputs());
  for (Eigen::Index i = 0; i < rows.rows(); ++i) {
    gp.Predict(rows.row(i).transpose(), 0, &workspace, mean, &result.variances[i]);
    result.means.row(i) = mean.transpose();
  }
  return result;
}

}  // namespace pleat
