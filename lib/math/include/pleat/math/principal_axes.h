// The directions in which points in space spread.
#pragma once

#include <Eigen/Core>

namespace pleat {

// Returns the principal axes of points about `center` as orthonormal columns, the direction of the
// least spread first. The sign of each is arbitrary, so the columns may be left-handed.
// points: 3 x N.
Eigen::Matrix3d PrincipalAxes(const Eigen::Ref<const Eigen::Matrix3Xd>& points,
                              const Eigen::Vector3d& center);

}  // namespace pleat
