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
  // J unit quaternions. rotations[0] turns the root in the world, rotations[b] turns bone b
  // relative to bone parent(b). Both are written in the axes of the rest pose, where all are the
  // identity.
  std::vector<Eigen::Quaterniond> rotations;

  static Pose Rest(const Skeleton& skeleton);
};

// OK when the root position is finite and every rotation is a unit quaternion to within 1 %, which
// normalizing corrects later. kInvalidArgument names the joint.
absl::Status CheckPose(const Pose& pose);
// OK when the pose has one rotation for each joint. kInvalidArgument names both counts.
absl::Status CheckJointCount(const Pose& pose, int num_joints);

// Sets `pose` to `a` at fraction 0 and to `b` at fraction 1; fractions outside [0, 1] extrapolate.
// Rotations are interpolated by slerp, the root linearly. Both must have the same joints. It
// allocates nothing once `pose` has the right size; `pose` must be neither of the two.
void InterpolatePoses(const Pose& a, const Pose& b, double fraction, Pose* pose);

// The motion of every bone in the world: x_world = linear[b] x_rest + translation[b]. Entry 0 is
// the root's own frame: it turns by R_0 about the root's rest position and moves to root_position.
struct BoneTransforms {
  std::vector<Eigen::Matrix3d> linear;       // J: R_b, or R_b S_b when bone b is stretched by S_b
  std::vector<Eigen::Vector3d> translation;  // J
  std::vector<Eigen::Matrix3d> rotation;     // J: R_b without the stretch
  Eigen::Matrix3Xd joint_positions;          // 3 x J, posed, meters
};

// Fills `transforms` and allocates nothing once it has the right size. `pose` must have the joints
// of `skeleton` (asserted). bone_scales: J factors on the lengths of the bones, of which entry 0 is
// ignored; or empty, when all are 1.
void ComputeBoneTransforms(const Skeleton& skeleton, const Pose& pose,
                           const std::vector<double>& bone_scales, BoneTransforms* transforms);

}  // namespace pleat
