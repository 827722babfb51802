#include "pleat/mesh/bounds.h"

namespace pleat {

Eigen::AlignedBox3d ComputeBounds(const Eigen::Ref<const Eigen::Matrix3Xd>& positions) {
  return {positions.rowwise().minCoeff(), positions.rowwise().maxCoeff()};
}

double BoundsDiagonal(const Eigen::Ref<const Eigen::Matrix3Xd>& positions) {
  return ComputeBounds(positions).diagonal().norm();
}

}  // namespace pleat
