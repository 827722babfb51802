#include "pleat/learner/nearest.h"

#include <cassert>

namespace pleat {

std::vector<int> NearestRows(const Eigen::Ref<const Eigen::MatrixXd>& training,
                             const Eigen::Ref<const Eigen::MatrixXd>& queries) {
  assert(training.rows() > 0 && training.cols() == queries.cols());
  std::vector<int> nearest(queries.rows());
  for (Eigen::Index i = 0; i < queries.rows(); ++i) {
    (training.rowwise() - queries.row(i)).rowwise().squaredNorm().minCoeff(&nearest[i]);
  }
  return nearest;
}

}  // namespace pleat
