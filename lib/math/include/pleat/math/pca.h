// Principal components of a data matrix, as a rule with many more columns than rows.
#pragma once

#include <Eigen/Core>

namespace pleat {

// The decomposition data ~ 1 mean^T + scores * basis^T, where rows are samples.
struct PrincipalComponents {
  Eigen::VectorXd mean;    // D
  Eigen::MatrixXd basis;   // D x r, orthonormal columns, by falling variance
  Eigen::MatrixXd scores;  // N x r
  double kept_energy = 1;  // share of the centered sum of squares that r components carry, 0..1
};

struct PcaOptions {
  int max_components = 1 << 30;
  double min_energy = 1;  // stop at the first r that keeps this share
};

// Returns the principal components of `data` (N x D) from the N x N or D x D Gram matrix, whichever
// is smaller. Signs are fixed (the largest entry of each basis vector is positive), so that the
// result does not depend on the solver. Directions below 1e-12 of the largest variance are dropped.
// See docs/method/details.md#detail-basis.
PrincipalComponents ComputePca(const Eigen::Ref<const Eigen::MatrixXd>& data,
                               const PcaOptions& options = {});

}  // namespace pleat
