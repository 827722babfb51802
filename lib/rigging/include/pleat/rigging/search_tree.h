// The human template as the embedding search sees it: seven joints, rooted at the chest
// (docs/method/rig.md#the-template).
#pragma once

#include <Eigen/Core>
#include <vector>

namespace pleat {

// One joint of the reduced skeleton and the chain of template bones that leads to it.
struct SearchJoint {
  int human_joint = 0;   // HumanJoint
  int parent = -1;       // index in the search tree, smaller than the joint's own; -1 = root
  int mirror = -1;       // its counterpart on the other side, -1 = none
  bool is_foot = false;  // stands on the floor
  bool is_deep = false;  // sits deep in the body (published flag: fat)
  bool is_leaf = false;
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  // template, unit box, turned by the yaw
  // The template joints after the parent's up to and including this one; for each of them the share
  // of the chain's length that lies before it (the last is 1) and the unit direction of its bone.
  std::vector<int> chain;
  std::vector<double> fractions;
  Eigen::Matrix3Xd directions;   // 3 x chain
  Eigen::VectorXd bone_lengths;  // template, unit box
  double length = 0;             // length of the chain, unit box
};

using SearchTree = std::vector<SearchJoint>;

// Returns the 18-joint human template without its joints of degree two, in the order chest, hips,
// head, left toes, right toes, left hand, right hand. `body_size` is the template's height in the
// unit box; `yaw_rad` turns the template about +y (0 = the character faces +z).
SearchTree MakeHumanSearchTree(double body_size, double yaw_rad);

}  // namespace pleat
