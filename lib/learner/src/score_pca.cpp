#include "score_pca.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

namespace pleat {

ScorePca::ScorePca(const Eigen::MatrixXd& scores) : num_rows_(double(scores.rows())) {
  const Eigen::MatrixXd centered = scores.rowwise() - scores.colwise().mean();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(centered.transpose() * centered);
  const Eigen::VectorXd& values = solver.eigenvalues();  // ascending
  const double smallest = 1e-12 * std::max(0.0, values[values.size() - 1]);
  Eigen::Index rank = 0;
  while (rank < values.size() && values[values.size() - 1 - rank] > smallest) ++rank;
  root_ = values.tail(rank).cwiseSqrt().asDiagonal() *
          solver.eigenvectors().rightCols(rank).transpose();
}

ScorePca::Components ScorePca::Compute(const Eigen::MatrixXd& map, int max_components,
                                       double largest_rest) const {
  Components result;
  const Eigen::MatrixXd data = root_ * map.transpose();  // k x n
  if (!(data.squaredNorm() > 0)) {
    result.basis = Eigen::MatrixXd::Zero(map.rows(), 1);
    result.rms = Eigen::VectorXd::Zero(1);
    return result;
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(data * data.transpose());
  const Eigen::VectorXd values = solver.eigenvalues().reverse().cwiseMax(0);
  const double enough = largest_rest * largest_rest * num_rows_ * double(map.rows());
  Eigen::Index count = 0;
  for (double rest = values.sum(); count < std::min<Eigen::Index>(values.size(), max_components) &&
                                   (count == 0 || rest > enough) &&
                                   values[count] > 1e-12 * values[0];) {
    rest -= values[count++];
  }
  result.basis.resize(map.rows(), count);
  result.rms = (values.head(count) / num_rows_).cwiseSqrt();
  for (Eigen::Index k = 0; k < count; ++k) {
    result.basis.col(k) =
        data.transpose() * solver.eigenvectors().col(values.size() - 1 - k) / std::sqrt(values[k]);
    Eigen::Index largest = 0;
    result.basis.col(k).cwiseAbs().maxCoeff(&largest);
    if (result.basis(largest, k) < 0) result.basis.col(k) *= -1;
  }
  return result;
}

PrincipalComponents FirstComponents(const PrincipalComponents& components, int max_components,
                                    double min_energy) {
  const Eigen::VectorXd energies = components.scores.colwise().squaredNorm();
  const double all = components.kept_energy > 0 ? energies.sum() / components.kept_energy : 0;
  Eigen::Index count = 0;
  double kept = 0;
  while (count < std::min<Eigen::Index>(energies.size(), max_components) &&
         (count == 0 || kept < min_energy * all)) {
    kept += energies[count++];
  }
  return {.mean = components.mean,
          .basis = components.basis.leftCols(count),
          .scores = components.scores.leftCols(count),
          .kept_energy = all > 0 ? kept / all : 1};
}

double DetailRms(const Eigen::MatrixXd& basis, const Eigen::VectorXd& score_rms) {
  return std::sqrt((basis * score_rms.asDiagonal()).squaredNorm() / double(basis.rows()));
}

Eigen::VectorXd LargestSteps(const Eigen::VectorXd& score_rms, double detail_rms, double rounding) {
  return rounding * std::sqrt(12.0) * detail_rms * score_rms.cwiseMax(1e-300).cwiseInverse();
}

}  // namespace pleat
