// Poses, pose tracks and forward kinematics (docs/method/fit.md#bone-model).
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <vector>

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

// Poses over time. A clip is a run of consecutive frames of one recording; history and dynamics
// never reach across a clip boundary.
struct PoseTrack {
  double fps = 30;
  std::vector<Pose> poses;          // T
  std::vector<int> clip_starts{0};  // first frame of every clip, ascending, first is 0

  int num_frames() const { return static_cast<int>(poses.size()); }
};

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
