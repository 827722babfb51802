#include "body_axes.h"

#include <cmath>

#include "pleat/motion/landmarks.h"

namespace pleat {
namespace {

Eigen::Matrix3d YawTurn(double yaw) {
  return Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitY()).toRotationMatrix();
}

}  // namespace

absl::StatusOr<BodyAxes> FindBodyAxes(const Skeleton& skeleton) {
  BodyAxes axes;
  std::vector<JointWord> words;
  for (const Joint& joint : skeleton.joints()) words.push_back(JointWordOf(joint.name));
  Eigen::Vector3d left = Eigen::Vector3d::Zero();
  for (int j = 0; j < skeleton.num_joints(); ++j) {
    const JointWord& word = words[static_cast<size_t>(j)];
    int other = j;
    for (int k = 0; word.side != 0 && k < skeleton.num_joints(); ++k) {
      const JointWord& candidate = words[static_cast<size_t>(k)];
      if (candidate.word == word.word && candidate.side == -word.side) other = k;
    }
    axes.mirror_joints.push_back(other);
    left += word.side * (skeleton.rest_position(j) - skeleton.rest_position(other));
  }
  // A pair counts only when each of the two is the other of the other.
  for (size_t j = 0; j < axes.mirror_joints.size(); ++j) {
    const auto other = static_cast<size_t>(axes.mirror_joints[j]);
    if (static_cast<size_t>(axes.mirror_joints[other]) != j) {
      axes.mirror_joints[j] = static_cast<int>(j);
    }
  }
  left.y() = 0;
  if (!(left.norm() > 1e-9)) {
    return absl::InvalidArgumentError(
        "the joints of the character have no left and right by their names, so its front is not "
        "known");
  }
  axes.left = left.normalized();
  axes.front = axes.left.cross(Eigen::Vector3d::UnitY());
  return axes;
}

GroundMove GroundMove::Inverse() const { return {-yaw_rad, -(YawTurn(-yaw_rad) * shift)}; }

GroundMove GroundMove::operator*(const GroundMove& other) const {
  return {yaw_rad + other.yaw_rad, YawTurn(yaw_rad) * other.shift + shift};
}

void GroundMove::Apply(Pose* pose) const {
  pose->root_position = YawTurn(yaw_rad) * pose->root_position + shift;
  pose->rotations[0] =
      (Eigen::AngleAxisd(yaw_rad, Eigen::Vector3d::UnitY()) * pose->rotations[0]).normalized();
}

GroundMove GroundOf(const Pose& pose, const BodyAxes& axes) {
  const Eigen::Vector3d front = pose.rotations[0] * axes.front;
  GroundMove move;
  move.yaw_rad = std::atan2(front.x(), front.z()) - std::atan2(axes.front.x(), axes.front.z());
  move.shift = {pose.root_position.x(), 0, pose.root_position.z()};
  return move;
}

}  // namespace pleat
