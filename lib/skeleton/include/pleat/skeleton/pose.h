// Poses and forward kinematics (docs/method/fit.md#bone-model).
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <vector>

#include "absl/status/status.h"
#include "pleat/math/rigid.h"
#include "pleat/skeleton/skeleton.h"

namespace pleat {

// One pose of a skeleton with J joints.
struct Pose {
  Eigen::Vector3d root_position = Eigen::Vector3d::Zero();  // joint 0 in the world, meters
  // rotations[0]: root, world. rotations[b]: bone b relative to bone parent(b), in the axes of the
  // rest pose (all identity = rest pose). Unit quaternions.
  std::vector<Eigen::Quaterniond> rotations;

  static Pose Rest(const Skeleton& skeleton);
};

// OK when the root position is finite and the rotations are unit quaternions (to 1 %, which their
// use normalizes away); kInvalidArgument names the joint.
absl::Status CheckPose(const Pose& pose);
// OK when the pose has one rotation for each joint; kInvalidArgument names both counts.
absl::Status CheckJointCount(const Pose& pose, int num_joints);

// World motion of every bone: x_world = bone_transforms[b] * x_rest. Entry 0 is the root's own
// frame (rotation R_0 about the rest root position, moved to root_position).
struct BoneTransforms {
  std::vector<Eigen::Matrix3d> linear;       // J: R_b, or R_b S_b with scaled bone lengths
  std::vector<Eigen::Vector3d> translation;  // J
  std::vector<Eigen::Matrix3d> rotation;     // J: R_b without the stretch
  Eigen::Matrix3Xd joint_positions;          // 3 x J, posed, meters
};

// Fills `transforms`, reusing its memory: no allocation once it has the right size.
// bone_scales: J entries (entry 0 ignored) or empty for ones.
void ComputeBoneTransforms(const Skeleton& skeleton, const Pose& pose,
                           const std::vector<double>& bone_scales, BoneTransforms* transforms);

}  // namespace pleat
