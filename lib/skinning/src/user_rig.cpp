#include "pleat/skinning/user_rig.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include "absl/strings/str_cat.h"
#include "pleat/base/status.h"

namespace pleat {
namespace {

absl::Status CheckInfluences(const std::vector<std::vector<JointInfluence>>& influences,
                             int num_joints) {
  for (size_t v = 0; v < influences.size(); ++v) {
    double total = 0;
    for (const JointInfluence& influence : influences[v]) {
      if (influence.joint < 0 || influence.joint >= num_joints ||
          !std::isfinite(influence.weight) || influence.weight < 0) {
        return absl::InvalidArgumentError(
            absl::StrCat("vertex ", v, ": weight ", influence.weight, " of joint ", influence.joint,
                         " (the rig has ", num_joints, " joints) is invalid"));
      }
      total += influence.weight;
    }
    if (!(total > 0)) {
      return absl::InvalidArgumentError(
          absl::StrCat("vertex ", v,
                       " has no skinning weight: weigh every vertex, or leave the "
                       "weights out to have them computed"));
    }
  }
  return absl::OkStatus();
}

// Adds an end to every leaf that moves vertices. The end is as far behind the weighted center of
// the vertices as the joint lies before it, so the bone runs through them.
absl::StatusOr<Skeleton> WithEnds(const Skeleton& skeleton,
                                  const std::vector<std::vector<JointInfluence>>& influences,
                                  const Eigen::Ref<const Eigen::Matrix3Xd>& positions) {
  Eigen::Matrix4Xd sums = Eigen::Matrix4Xd::Zero(4, skeleton.num_joints());  // w x, w
  for (size_t v = 0; v < influences.size(); ++v) {
    for (const JointInfluence& influence : influences[v]) {
      sums.col(influence.joint) +=
          influence.weight * positions.col(static_cast<Eigen::Index>(v)).homogeneous();
    }
  }
  std::vector<Joint> joints = skeleton.joints();
  for (int j = 0; j < skeleton.num_joints(); ++j) {
    if (!skeleton.children(j).empty() || !(sums(3, j) > 0)) continue;
    std::string name = absl::StrCat(skeleton.joint(j).name, "_end");
    while (skeleton.FindJoint(name) >= 0) name += '_';
    const Eigen::Vector3d center = sums.col(j).hnormalized();
    joints.push_back({name, j, 2 * center - skeleton.rest_position(j)});
  }
  if (joints.size() > kMaxUserJoints) {
    return absl::InvalidArgumentError(absl::StrCat("the rig has ", joints.size(),
                                                   " joints with the ends of its leaves, the limit "
                                                   "is ",
                                                   kMaxUserJoints));
  }
  return Skeleton::Create(std::move(joints));
}

double SquaredDistanceToBone(const Skeleton& skeleton, int bone, const Eigen::Vector3d& point) {
  const Eigen::Vector3d start = skeleton.rest_position(skeleton.parent(bone));
  const Eigen::Vector3d along = skeleton.rest_position(bone) - start;
  const double squared = along.squaredNorm();
  const double share = squared > 0 ? std::clamp(along.dot(point - start) / squared, 0.0, 1.0) : 0.0;
  return (start + share * along - point).squaredNorm();
}

// Returns the bone that begins in `joint` and is nearest to `point`.
int BoneOfJoint(const Skeleton& skeleton, int joint, const Eigen::Vector3d& point) {
  int nearest = -1;
  double least = std::numeric_limits<double>::infinity();
  for (const int bone : skeleton.children(joint)) {
    const double distance = SquaredDistanceToBone(skeleton, bone, point);
    if (distance < least) {
      least = distance;
      nearest = bone;
    }
  }
  return nearest;
}

}  // namespace

bool operator==(const UserRig& a, const UserRig& b) {
  const auto same_joint = [](const Joint& x, const Joint& y) {
    return x.name == y.name && x.parent == y.parent && x.rest_position == y.rest_position;
  };
  const auto same_vertex = [](const VertexInfluences& x, const VertexInfluences& y) {
    return x.bones == y.bones && x.weights == y.weights;
  };
  return std::ranges::equal(a.skeleton.joints(), b.skeleton.joints(), same_joint) &&
         a.weights.has_value() == b.weights.has_value() &&
         (!a.weights ||
          std::ranges::equal(a.weights->influences(), b.weights->influences(), same_vertex)) &&
         a.rest_frame == b.rest_frame && a.locked_joints == b.locked_joints;
}

absl::StatusOr<UserRig> RigFromJointWeights(
    const Skeleton& skeleton, const std::vector<std::vector<JointInfluence>>& influences,
    const Eigen::Ref<const Eigen::Matrix3Xd>& positions) {
  if (static_cast<Eigen::Index>(influences.size()) != positions.cols()) {
    return absl::InvalidArgumentError(absl::StrCat("the rig weighs ", influences.size(),
                                                   " vertices, the mesh has ", positions.cols()));
  }
  PLEAT_RETURN_IF_ERROR(CheckInfluences(influences, skeleton.num_joints()));
  UserRig rig;
  PLEAT_ASSIGN_OR_RETURN(rig.skeleton, WithEnds(skeleton, influences, positions));
  std::vector<VertexInfluences> vertices;
  vertices.reserve(influences.size());
  for (size_t v = 0; v < influences.size(); ++v) {
    std::map<int, double> bone_weights;
    for (const JointInfluence& influence : influences[v]) {
      if (!(influence.weight > 0)) continue;
      bone_weights[BoneOfJoint(rig.skeleton, influence.joint,
                               positions.col(static_cast<Eigen::Index>(v)))] += influence.weight;
    }
    vertices.push_back(StrongestInfluences(bone_weights));
  }
  PLEAT_ASSIGN_OR_RETURN(rig.weights,
                         SkinWeights::Create(rig.skeleton.num_joints(), std::move(vertices)));
  return rig;
}

}  // namespace pleat
