#include "pleat/skeleton/skeleton.h"

#include <set>
#include <utility>

#include "absl/strings/str_cat.h"

namespace pleat {

absl::StatusOr<Skeleton> Skeleton::Create(std::vector<Joint> joints) {
  if (joints.empty()) return absl::InvalidArgumentError("a skeleton needs at least one joint");
  std::set<std::string> names;
  Skeleton skeleton;
  skeleton.children_.resize(joints.size());
  for (size_t j = 0; j < joints.size(); ++j) {
    const Joint& joint = joints[j];
    const bool parent_ok =
        j == 0 ? joint.parent == -1 : joint.parent >= 0 && joint.parent < static_cast<int>(j);
    if (!parent_ok) {
      return absl::InvalidArgumentError(absl::StrCat(
          "joint ", j, " ('", joint.name, "') has parent ", joint.parent,
          "; the first joint must be the only root (-1) and parents must come before children"));
    }
    if (joint.name.empty() || !names.insert(joint.name).second) {
      return absl::InvalidArgumentError(
          absl::StrCat("joint ", j, ": the name '", joint.name, "' is empty or used twice"));
    }
    if (!joint.rest_position.allFinite()) {
      return absl::InvalidArgumentError(absl::StrCat("joint ", j, " ('", joint.name,
                                                     "') has a rest position that is not finite"));
    }
    if (j > 0) skeleton.children_[joint.parent].push_back(static_cast<int>(j));
  }
  skeleton.joints_ = std::move(joints);
  return skeleton;
}

int Skeleton::FindJoint(const std::string& name) const {
  for (int j = 0; j < num_joints(); ++j) {
    if (joints_[j].name == name) return j;
  }
  return -1;
}

Skeleton Skeleton::WithRestPositions(const Eigen::Matrix3Xd& positions) const {
  Skeleton moved = *this;
  for (int j = 0; j < num_joints(); ++j) moved.joints_[j].rest_position = positions.col(j);
  return moved;
}

Eigen::Matrix3Xd Skeleton::RestPositions() const {
  Eigen::Matrix3Xd positions(3, num_joints());
  for (int j = 0; j < num_joints(); ++j) positions.col(j) = joints_[j].rest_position;
  return positions;
}

}  // namespace pleat
