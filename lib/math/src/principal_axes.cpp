#include "pleat/math/principal_axes.h"

#include <Eigen/Eigenvalues>

namespace pleat {

Eigen::Matrix3d PrincipalAxes(const Eigen::Ref<const Eigen::Matrix3Xd>& points,
                              const Eigen::Vector3d& center) {
  const Eigen::Matrix3Xd centered = points.colwise() - center;
  return Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(centered * centered.transpose())
      .eigenvectors();
}

}  // namespace pleat
