// The directions of a body at rest, and where a pose stands on the ground.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "absl/status/statusor.h"
#include "pleat/skeleton/pose.h"
#include "pleat/skeleton/skeleton.h"

namespace pleat {

struct BodyAxes {
  Eigen::Vector3d left, front;     // horizontal unit vectors of the rest pose
  std::vector<int> mirror_joints;  // J: the joint on the other side, or the joint itself
};
// Pairs joints by their names ("leftFoot" and "rightFoot"); the axis to the left is the mean of
// what lies between the two of a pair. kInvalidArgument when no pair shows it.
absl::StatusOr<BodyAxes> FindBodyAxes(const Skeleton& skeleton);

// A turn about the vertical axis and a way along the ground: x -> Ry(yaw) x + shift.
struct GroundMove {
  double yaw_rad = 0;
  Eigen::Vector3d shift = Eigen::Vector3d::Zero();  // y is 0

  GroundMove Inverse() const;
  GroundMove operator*(const GroundMove& other) const;
  void Apply(Pose* pose) const;
};
// Where the root of a pose is on the ground, and where it faces there, from the rest at the origin.
GroundMove GroundOf(const Pose& pose, const BodyAxes& axes);

}  // namespace pleat
