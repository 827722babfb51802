// Axis-aligned bounds of a frame.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace pleat {

// Returns the bounding box of `positions` (3 x V, V > 0).
Eigen::AlignedBox3d ComputeBounds(const Eigen::Ref<const Eigen::Matrix3Xd>& positions);

// Returns the length of the box diagonal, in meters: the unit of every error in percent.
double BoundsDiagonal(const Eigen::Ref<const Eigen::Matrix3Xd>& positions);

}  // namespace pleat
