#include "pose_argument.h"

#include <algorithm>

#include "error_report.h"

namespace pleat {

absl::Status TakePose(const pleat_pose& given, int num_joints, Pose* pose) {
  if (given.rotations == nullptr) return IsNull("rotations of a pose");
  if (given.num_joints != static_cast<size_t>(num_joints)) {
    return absl::InvalidArgumentError(
        absl::StrCat("the pose has ", given.num_joints, " joints, the model has ", num_joints));
  }
  pose->root_position = Eigen::Map<const Eigen::Vector3d>(given.root_position);
  pose->rotations.resize(given.num_joints);
  for (size_t j = 0; j < given.num_joints; ++j) {
    // The coefficients of Eigen's quaternions are x, y, z, w too.
    pose->rotations[j].coeffs() = Eigen::Map<const Eigen::Vector4d>(given.rotations + 4 * j);
  }
  return absl::OkStatus();
}

void ShowPose(const Pose& pose, double* rotations, pleat_pose* shown) {
  std::copy_n(pose.root_position.data(), 3, shown->root_position);
  for (size_t j = 0; j < pose.rotations.size(); ++j) {
    std::copy_n(pose.rotations[j].coeffs().data(), 4, rotations + 4 * j);
  }
  shown->rotations = rotations;
  shown->num_joints = pose.rotations.size();
}

}  // namespace pleat
