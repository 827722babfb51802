#include "pleat/motion/leg_joints.h"

#include "pleat/motion/landmarks.h"

namespace pleat {

double LegJoints::MeanLength(const Skeleton& skeleton) const {
  double sum = 0;
  for (const Leg& leg : legs) {
    sum += (skeleton.rest_position(leg.knee) - skeleton.rest_position(leg.hip)).norm();
    sum += (skeleton.rest_position(leg.ankle) - skeleton.rest_position(leg.knee)).norm();
  }
  return sum / 2;
}

absl::StatusOr<LegJoints> FindLegJoints(const Skeleton& skeleton) {
  const Landmarks landmarks = FindLandmarks(BodyJointsOf(skeleton));
  if (!landmarks.HasLegs()) {
    return absl::InvalidArgumentError("the character has no joints that are known as two legs");
  }
  LegJoints found;
  found.legs[0] = {landmarks[kLeftUpperLeg], landmarks[kLeftLowerLeg], landmarks[kLeftFoot],
                   landmarks[kLeftToes]};
  found.legs[1] = {landmarks[kRightUpperLeg], landmarks[kRightLowerLeg], landmarks[kRightFoot],
                   landmarks[kRightToes]};
  for (LegJoints::Leg& leg : found.legs) {
    if (skeleton.parent(leg.knee) != leg.hip || skeleton.parent(leg.ankle) != leg.knee) {
      return absl::InvalidArgumentError(
          "a leg of the character has further joints between hip, knee and ankle");
    }
    if (leg.toes >= 0 && skeleton.parent(leg.toes) != leg.ankle) leg.toes = -1;
  }
  return found;
}

std::array<FootPath, 2> FootPaths(const Skeleton& skeleton, const LegJoints& legs,
                                  const std::vector<Pose>& poses) {
  std::array<FootPath, 2> paths;
  for (FootPath& path : paths) {
    path.ankle.resize(3, static_cast<Eigen::Index>(poses.size()));
    path.toes.resize(3, static_cast<Eigen::Index>(poses.size()));
  }
  BoneTransforms transforms;
  for (size_t t = 0; t < poses.size(); ++t) {
    ComputeBoneTransforms(skeleton, poses[t], {}, &transforms);
    for (size_t side = 0; side < 2; ++side) {
      const LegJoints::Leg& leg = legs.legs[side];
      const auto frame = static_cast<Eigen::Index>(t);
      paths[side].ankle.col(frame) = transforms.joint_positions.col(leg.ankle);
      paths[side].toes.col(frame) =
          transforms.joint_positions.col(leg.toes < 0 ? leg.ankle : leg.toes);
    }
  }
  return paths;
}

}  // namespace pleat
