// Principal components of linear maps of data that are known by their scores in a basis.
#pragma once

#include <Eigen/Core>

#include "pleat/math/pca.h"

namespace pleat {

// With scores Z (N x K, centered here) and a map A (n x K), the data X = Z A^T (N x n) have the
// principal components of Y = H A^T, where H^T H = Z^T Z: a few hundred rows whatever N is.
class ScorePca {
 public:
  explicit ScorePca(const Eigen::MatrixXd& scores);

  struct Components {
    Eigen::MatrixXd basis;  // n x r, orthonormal columns, by falling variance
    Eigen::VectorXd rms;    // r: root mean square of each component's score
  };
  // As many components as leave out a root mean square of at most `largest_rest` per entry of the
  // data, but at most max_components; at least one, which is zero where the data do not vary. Signs
  // are fixed as in ComputePca.
  Components Compute(const Eigen::MatrixXd& map, int max_components, double largest_rest) const;

 private:
  Eigen::MatrixXd root_;  // H, k x K
  double num_rows_ = 0;
};

// The first components of `components`: as many as the share min_energy of all energy needs, at
// most max_components.
PrincipalComponents FirstComponents(const PrincipalComponents& components, int max_components,
                                    double min_energy);

// Root mean square of the details that a basis and scores of these root mean squares (r) stand for,
// over all entries, where scores are uncorrelated.
double DetailRms(const Eigen::MatrixXd& basis, const Eigen::VectorXd& score_rms);

// The coarsest steps (r) in which a basis may be rounded. Rounding to a step s errs by s / sqrt(12)
// RMS in each detail, times the component's score: the share `rounding` of detail_rms is allowed.
Eigen::VectorXd LargestSteps(const Eigen::VectorXd& score_rms, double detail_rms, double rounding);

}  // namespace pleat
