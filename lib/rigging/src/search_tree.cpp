// Why the search sees another skeleton than the rig has. A search over 18 joints would place knees
// and elbows on spheres although the surface says little about them: a straight leg has no sign of
// its knee. Joints of degree two are therefore dropped. What is left are the ends and the forks,
// which the shape does show, and a chain between two of them is laid along the shortest path
// through the body. The dropped joints come back at fixed shares of the path (`fractions`),
// refinement moves them later, and the search loses nothing, since the penalty of a chain still
// compares the direction of each of its bones with the path.
//
// The tree is rooted at the chest, not at the hips as the rig is: from the chest hang hips, head
// and both hands, from the hips both feet. The chain from the chest to the hips thus runs against
// the rig's bones (spine, then hips), and directions are those from the parent's side.
//
// The order of joints is the order in which the search places them, and it is part of the method:
//
// - A parent comes before its children. Placing, the tables of the bound, and the climb to a common
//   ancestor (PenaltyModel::MakeContext) rely on it.
// - Chest, hips and head come first. They have few candidates (the 50 largest spheres), and what
//   they cost decides early whether a facing has a chance.
// - Mirrored limbs follow each other, so that the second one is compared with the first.

#include "pleat/rigging/search_tree.h"

#include <Eigen/Geometry>

#include "pleat/skeleton/human_template.h"

namespace pleat {
namespace {

// Indices of parent and mirror are those in the list below.
struct ReducedJoint {
  HumanJoint joint;
  int parent, mirror;
  std::vector<HumanJoint> chain;
};

const std::vector<ReducedJoint>& ReducedHuman() {
  static const std::vector<ReducedJoint> kJoints = {
      {kChest, -1, -1, {}},
      {kHips, 0, -1, {kSpine, kHips}},
      {kHead, 0, -1, {kHead}},
      {kLeftToes, 1, 4, {kLeftUpperLeg, kLeftLowerLeg, kLeftFoot, kLeftToes}},
      {kRightToes, 1, 3, {kRightUpperLeg, kRightLowerLeg, kRightFoot, kRightToes}},
      {kLeftHand, 0, 6, {kLeftUpperArm, kLeftLowerArm, kLeftHand}},
      {kRightHand, 0, 5, {kRightUpperArm, kRightLowerArm, kRightHand}},
  };
  return kJoints;
}

}  // namespace

SearchTree MakeHumanSearchTree(double body_size, double yaw_rad) {
  const Eigen::Matrix3Xd positions =
      body_size * (Eigen::AngleAxisd(yaw_rad, Eigen::Vector3d::UnitY()).toRotationMatrix() *
                   HumanTemplate().RestPositions());
  SearchTree tree;
  for (const ReducedJoint& reduced : ReducedHuman()) {
    SearchJoint joint;
    joint.human_joint = reduced.joint;
    joint.parent = reduced.parent;
    joint.mirror = reduced.mirror;
    joint.is_foot = reduced.joint == kLeftToes || reduced.joint == kRightToes;
    joint.is_deep = reduced.joint == kHips || reduced.joint == kChest || reduced.joint == kHead;
    joint.is_leaf = reduced.joint != kHips && reduced.joint != kChest;
    joint.position = positions.col(reduced.joint);
    joint.chain.assign(reduced.chain.begin(), reduced.chain.end());
    joint.directions.resize(3, joint.chain.size());
    joint.bone_lengths.resize(static_cast<Eigen::Index>(joint.chain.size()));
    Eigen::Vector3d start = reduced.parent < 0 ? joint.position : tree[reduced.parent].position;
    for (size_t k = 0; k < joint.chain.size(); ++k) {
      const Eigen::Vector3d end = positions.col(joint.chain[k]);
      joint.bone_lengths[k] = (end - start).norm();
      joint.directions.col(k) = (end - start).normalized();
      start = end;
    }
    joint.length = joint.bone_lengths.sum();
    double before = 0;
    for (size_t k = 0; k < joint.chain.size(); ++k) {
      before += joint.bone_lengths[k];
      joint.fractions.push_back(before / joint.length);
    }
    tree.push_back(joint);
  }
  return tree;
}

}  // namespace pleat
