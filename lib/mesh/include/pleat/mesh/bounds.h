// Axis-aligned bounds of a frame.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace pleat {

// Bounding box of `positions` (3 x V).
Eigen::AlignedBox3d ComputeBounds(const Eigen::Ref<const Eigen::Matrix3Xd>& positions);

// Length of the box diagonal, meters: the unit of every error in percent.
double BoundsDiagonal(const Eigen::Ref<const Eigen::Matrix3Xd>& positions);

}  // namespace pleat
