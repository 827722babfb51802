#include "pleat/skeleton/pose.h"

#include <cassert>
#include <cmath>

#include "absl/strings/str_cat.h"

namespace pleat {

Pose Pose::Rest(const Skeleton& skeleton) {
  Pose pose;
  pose.root_position = skeleton.rest_position(0);
  pose.rotations.assign(skeleton.num_joints(), Eigen::Quaterniond::Identity());
  return pose;
}

absl::Status CheckPose(const Pose& pose) {
  constexpr double kUnitTolerance = 1e-2;
  if (!pose.root_position.allFinite()) {
    return absl::InvalidArgumentError("the pose's root position is not finite");
  }
  for (size_t j = 0; j < pose.rotations.size(); ++j) {
    const double norm = pose.rotations[j].norm();
    if (!(std::abs(norm - 1) < kUnitTolerance)) {  // written so that a NaN fails
      return absl::InvalidArgumentError(absl::StrCat("the rotation of joint ", j, " (rotations[", j,
                                                     "]) has norm ", norm,
                                                     "; send unit quaternions"));
    }
  }
  return absl::OkStatus();
}

absl::Status CheckJointCount(const Pose& pose, int num_joints) {
  if (static_cast<int>(pose.rotations.size()) == num_joints) return absl::OkStatus();
  return absl::InvalidArgumentError(absl::StrCat("the pose has ", pose.rotations.size(),
                                                 " rotations, the skeleton has ", num_joints,
                                                 " joints"));
}

void InterpolatePoses(const Pose& a, const Pose& b, double fraction, Pose* pose) {
  assert(a.rotations.size() == b.rotations.size() && pose != &a && pose != &b);
  pose->root_position = a.root_position + fraction * (b.root_position - a.root_position);
  pose->rotations.resize(a.rotations.size());
  for (size_t j = 0; j < a.rotations.size(); ++j) {
    pose->rotations[j] = a.rotations[j].slerp(fraction, b.rotations[j]).normalized();
  }
}

// One pass from the root to the leaves, in which every parent comes before its children. R_b is the
// product of the rotations on the way from the root to bone b. The bone turns about its parent
// joint, which has been placed by then and is the pivot.
//
// A bone scale s stretches the bone along its own direction u at rest and nothing else, by the
// matrix S_b = I + (s - 1) u u^T. So R_b S_b = R_b + (s - 1) (R_b u) u^T, where u = bone / |bone|.
// Children begin at the end of the stretched bone but are not stretched with it, because R_b and
// not R_b S_b is passed on to them.
void ComputeBoneTransforms(const Skeleton& skeleton, const Pose& pose,
                           const std::vector<double>& bone_scales, BoneTransforms* transforms) {
  const int num_joints = skeleton.num_joints();
  assert(static_cast<int>(pose.rotations.size()) == num_joints);
  assert(bone_scales.empty() || static_cast<int>(bone_scales.size()) == num_joints);
  transforms->linear.resize(num_joints);
  transforms->translation.resize(num_joints);
  transforms->rotation.resize(num_joints);
  transforms->joint_positions.resize(3, num_joints);

  transforms->rotation[0] = pose.rotations[0].toRotationMatrix();
  transforms->linear[0] = transforms->rotation[0];
  transforms->translation[0] =
      pose.root_position - transforms->rotation[0] * skeleton.rest_position(0);
  transforms->joint_positions.col(0) = pose.root_position;
  for (int b = 1; b < num_joints; ++b) {
    const int parent = skeleton.parent(b);
    const Eigen::Vector3d& pivot_rest = skeleton.rest_position(parent);
    const Eigen::Vector3d bone = skeleton.rest_position(b) - pivot_rest;
    transforms->rotation[b] = transforms->rotation[parent] * pose.rotations[b].toRotationMatrix();
    transforms->linear[b] = transforms->rotation[b];
    const double length_squared = bone.squaredNorm();
    if (!bone_scales.empty() && length_squared > 0) {  // stretches along the axis of the bone only
      transforms->linear[b] += (bone_scales[b] - 1) / length_squared *
                               (transforms->rotation[b] * bone) * bone.transpose();
    }
    const Eigen::Vector3d pivot = transforms->joint_positions.col(parent);
    transforms->translation[b] = pivot - transforms->linear[b] * pivot_rest;
    transforms->joint_positions.col(b) = pivot + transforms->linear[b] * bone;
  }
}

}  // namespace pleat
