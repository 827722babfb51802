// A joint hierarchy in its rest pose.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "absl/status/statusor.h"

namespace pleat {

struct Joint {
  std::string name;
  int parent = -1;                // an index below the joint's own, or -1 for the root alone
  Eigen::Vector3d rest_position;  // meters, world, Y up
};

// Joints in an order with parents before children. Joint 0 is the root and has no bone. Bone b, for
// b >= 1, is the segment from joint parent(b) to joint b and turns about parent(b)
// (docs/method/rig.md#the-template), so each joint but the root stands for one bone and its
// rotation.
class Skeleton {
 public:
  // kInvalidArgument names the first joint whose parent or order is wrong, whose position is not
  // finite, or whose name is empty or there twice.
  static absl::StatusOr<Skeleton> Create(std::vector<Joint> joints);

  int num_joints() const { return static_cast<int>(joints_.size()); }
  const Joint& joint(int j) const { return joints_[j]; }
  const std::vector<Joint>& joints() const { return joints_; }
  int parent(int j) const { return joints_[j].parent; }
  const Eigen::Vector3d& rest_position(int j) const { return joints_[j].rest_position; }
  const std::vector<int>& children(int j) const { return children_[j]; }
  int FindJoint(const std::string& name) const;  // an index, or -1 when there is no such joint

  // Returns the same hierarchy with other rest positions (3 x J, meters).
  Skeleton WithRestPositions(const Eigen::Matrix3Xd& positions) const;
  Eigen::Matrix3Xd RestPositions() const;  // 3 x J, meters

 private:
  std::vector<Joint> joints_;
  std::vector<std::vector<int>> children_;
};

}  // namespace pleat
