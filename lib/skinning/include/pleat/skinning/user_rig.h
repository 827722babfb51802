// A rig that the user brings, with any joints and any names (docs/method/rig.md#user-rigs).
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "absl/status/statusor.h"
#include "pleat/skeleton/skeleton.h"
#include "pleat/skinning/skin_weights.h"

namespace pleat {

inline constexpr int kMaxUserJoints = 256;

struct UserRig {
  Skeleton skeleton;                   // 2..256 joints; rest positions in the pose of `rest_frame`
  std::optional<SkinWeights> weights;  // absent: computed by heat
  int rest_frame = 0;                  // frame of the first clip whose pose is the rest pose
  std::vector<int> locked_joints;      // ascending; refinement leaves them where they are

  friend bool operator==(const UserRig& a, const UserRig& b);
};

// One influence as other packages have it: the vertex moves with the joint's own frame.
struct JointInfluence {
  int joint = 0;
  double weight = 0;
};

// Makes bone weights from joint weights. A Pleat bone b turns about joint parent(b) (skeleton.h):
// what moves with a joint moves with the bone that begins there, or with the nearest of them where
// there are several; where there is none, the joint gets a child "<name>_end" at the far side of
// its vertices. Names, order and hierarchy of the given joints stay; ends come after them.
// positions: 3 x V, rest pose; influences: V, any number per vertex, of which the four strongest
// are kept. The error is kInvalidArgument and names the first vertex without weight or with one
// that is not a joint's; it is the same when joints and ends together are more than 256.
absl::StatusOr<UserRig> RigFromJointWeights(
    const Skeleton& skeleton, const std::vector<std::vector<JointInfluence>>& influences,
    const Eigen::Ref<const Eigen::Matrix3Xd>& positions);

}  // namespace pleat
