// What tests of bodies share: their height, turns, and the volume as the search sees it.
#pragma once

#include <Eigen/Geometry>

#include "pleat/rigging/body_volume.h"
#include "support/triangle_shapes.h"

namespace pleat {

inline constexpr double kHeight = 1.7;  // meters, of the capsule figure

inline Eigen::Matrix3d TurnAbout(const Eigen::Vector3d& axis, double degrees) {
  return Eigen::AngleAxisd(degrees * EIGEN_PI / 180, axis.normalized()).toRotationMatrix();
}

inline BodyVolume VolumeOf(const TriangleMesh& mesh) {
  return ComputeBodyVolume(MakeTopology(mesh), mesh.positions, {.resolution = 64}).value();
}

}  // namespace pleat
