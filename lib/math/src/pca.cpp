#include "pleat/math/pca.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

namespace pleat {
namespace {

// Flips each column so that its entry of largest magnitude is positive; `partner` follows.
void FixSigns(Eigen::MatrixXd& basis, Eigen::MatrixXd& partner) {
  for (Eigen::Index c = 0; c < basis.cols(); ++c) {
    Eigen::Index row;
    basis.col(c).cwiseAbs().maxCoeff(&row);
    if (basis(row, c) < 0) {
      basis.col(c) = -basis.col(c);
      partner.col(c) = -partner.col(c);
    }
  }
}

// Returns (X - 1 m^T)(X - 1 m^T)^T from X X^T, so that no centered copy is made of a matrix that
// may be the largest thing in memory.
Eigen::MatrixXd CenteredGram(const Eigen::Ref<const Eigen::MatrixXd>& data) {
  Eigen::MatrixXd gram = data * data.transpose();
  const Eigen::VectorXd row_means = gram.rowwise().mean();
  const double mean = row_means.mean();
  gram.colwise() -= row_means;
  gram.rowwise() -= row_means.transpose();
  gram.array() += mean;
  return gram;
}

}  // namespace

PrincipalComponents ComputePca(const Eigen::Ref<const Eigen::MatrixXd>& data,
                               const PcaOptions& options) {
  PrincipalComponents pca;
  pca.mean = data.colwise().mean().transpose();
  const bool by_rows = data.rows() <= data.cols();
  Eigen::MatrixXd centered;  // made of tall matrices only
  if (!by_rows) centered = data.rowwise() - pca.mean.transpose();
  const Eigen::MatrixXd gram =
      by_rows ? CenteredGram(data) : Eigen::MatrixXd(centered.transpose() * centered);
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(gram);
  const Eigen::VectorXd values = solver.eigenvalues().reverse().cwiseMax(0);
  const double total = values.sum();

  Eigen::Index rank = 0;
  double energy = 0;
  while (rank < std::min<Eigen::Index>(values.size(), options.max_components) &&
         values[rank] > 1e-12 * values[0] && (rank == 0 || energy < options.min_energy * total)) {
    energy += values[rank++];
  }
  pca.kept_energy = total > 0 ? energy / total : 1;
  const Eigen::MatrixXd vectors = solver.eigenvectors().rowwise().reverse().leftCols(rank);
  const Eigen::VectorXd lengths = values.head(rank).cwiseSqrt();
  if (by_rows) {  // basis = centered^T U / sigma
    pca.scores = vectors * lengths.asDiagonal();
    pca.basis = data.transpose() * vectors;
    pca.basis -= pca.mean * vectors.colwise().sum();
    pca.basis *= lengths.cwiseInverse().asDiagonal();
  } else {
    pca.basis = vectors;
    pca.scores = centered * vectors;
  }
  FixSigns(pca.basis, pca.scores);
  return pca;
}

}  // namespace pleat
