#include "pleat/motion/landmarks.h"

#include <algorithm>
#include <initializer_list>
#include <span>

namespace pleat {
namespace {

// The words of a part of a limb, the surest first. Some mean different joints in different
// skeletons (the shoulder of Mixamo is the collar bone, that of CMU the upper arm; the foot of SMPL
// holds the toes), so a limb is taken as a whole: the first words whose joints hang below each
// other.
using Words = std::vector<std::string_view>;
const Words kUpperLegWords = {"upleg",     "upperleg",   "thigh", "femur", "thighbend",
                              "uplegbend", "thightwist", "hip",   "leg",   "hipjoint"};
const Words kLowerLegWords = {"lowerleg", "lowleg",   "knee",  "shin",
                              "calf",     "shinbend", "tibia", "leg"};
const Words kFootWords = {"ankle", "foot"};
const Words kToeWords = {"toebase", "toes", "toe", "ball", "metatarsals", "foot"};
const Words kUpperArmWords = {"upperarm", "uparm", "humerus", "shldrbend",
                              "shldr",    "arm",   "shoulder"};
const Words kLowerArmWords = {"lowerarm", "lowarm", "forearm", "forearmbend", "elbow", "radius"};
const Words kHandWords = {"wrist", "hand"};

class LandmarkFinder {
 public:
  explicit LandmarkFinder(const std::vector<BodyJoint>& joints) : joints_(joints) {
    for (const BodyJoint& joint : joints) words_.push_back(JointWordOf(joint.name));
  }

  Landmarks Find() {
    const std::vector<const Words*> leg = {&kUpperLegWords, &kLowerLegWords, &kFootWords};
    const std::vector<const Words*> arm = {&kUpperArmWords, &kLowerArmWords, &kHandWords};
    for (const bool left : {true, false}) {
      const int side = left ? 1 : -1;
      FindLimb(leg, side, left ? kLeftUpperLeg : kRightUpperLeg);
      FindLimb(arm, side, left ? kLeftUpperArm : kRightUpperArm);
      FindToes(side, left ? kLeftFoot : kRightFoot, left ? kLeftToes : kRightToes);
    }
    FindTrunk();
    return found_;
  }

 private:
  int& At(int joint) { return found_.joints[static_cast<size_t>(joint)]; }

  std::vector<int> Named(const Words& words, int side) const {
    std::vector<int> named;
    for (const std::string_view word : words) {
      for (size_t j = 0; j < joints_.size(); ++j) {
        if (joints_[j].is_end || words_[j].side != side || words_[j].word != word) continue;
        named.push_back(static_cast<int>(j));
      }
    }
    return named;
  }

  // Sets the three joints from `first` on.
  void FindLimb(const std::vector<const Words*>& parts, int side, int first) {
    const std::vector<int> lower = Named(*parts[1], side), ends = Named(*parts[2], side);
    for (const int upper : Named(*parts[0], side)) {
      for (const int middle : lower) {
        if (middle == upper || !IsAtOrAbove(joints_, upper, middle)) continue;
        for (const int end : ends) {
          if (end == middle || !IsAtOrAbove(joints_, middle, end)) continue;
          At(first) = upper;
          At(first + 1) = middle;
          At(first + 2) = end;
          return;
        }
      }
    }
  }

  double DistanceAbove(int joint) const {
    const BodyJoint& j = joints_[static_cast<size_t>(joint)];
    if (j.parent < 0) return 0;
    return (j.rest_position - joints_[static_cast<size_t>(j.parent)].rest_position).norm();
  }

  // By name, or else what hangs furthest from the ankle, a tip included.
  void FindToes(int side, int foot, int toes) {
    const int ankle = At(foot);
    if (ankle < 0) return;
    for (const int toe : Named(kToeWords, side)) {
      if (toe == ankle || !IsAtOrAbove(joints_, ankle, toe)) continue;
      At(toes) = toe;
      return;
    }
    double furthest = 0;
    for (size_t j = 0; j < joints_.size(); ++j) {
      if (joints_[j].parent != ankle || DistanceAbove(static_cast<int>(j)) <= furthest) continue;
      furthest = DistanceAbove(static_cast<int>(j));
      At(toes) = static_cast<int>(j);
    }
  }

  // The lowest joint that is at or above all of `below` that are there, or -1.
  int CommonAncestor(std::initializer_list<int> below) const {
    int common = -1;
    for (const int joint : below) {
      if (joint < 0) continue;
      if (common < 0) common = joint;
      while (common >= 0 && !IsAtOrAbove(joints_, common, joint)) {
        common = joints_[static_cast<size_t>(common)].parent;
      }
    }
    return common;
  }

  void FindTrunk() {
    At(kHead) = FindHead();
    const int left_leg = At(kLeftUpperLeg), right_leg = At(kRightUpperLeg);
    const int left_arm = At(kLeftUpperArm), right_arm = At(kRightUpperArm);
    const int branch = CommonAncestor({left_leg, right_leg, left_arm, right_arm, At(kHead)});
    At(kHips) = left_leg >= 0 && right_leg >= 0 ? branch : -1;
    if (left_arm >= 0 && right_arm >= 0) {
      At(kChest) = CommonAncestor({left_arm, right_arm, At(kHead)});
    }
    if (At(kHips) < 0 || At(kChest) < 0 || At(kChest) == At(kHips)) return;
    std::vector<int> path;  // below the hips, up to the chest
    for (int j = At(kChest); j >= 0 && j != At(kHips); j = joints_[static_cast<size_t>(j)].parent) {
      path.insert(path.begin(), j);
    }
    if (path.size() >= 2) At(kSpine) = path[(path.size() - 1) / 2];
  }

  int FindHead() const {
    for (size_t j = 0; j < joints_.size(); ++j) {
      if (!joints_[j].is_end && words_[j].side == 0 && words_[j].word == "head") {
        return static_cast<int>(j);
      }
    }
    return -1;
  }

  const std::vector<BodyJoint>& joints_;
  std::vector<JointWord> words_;
  Landmarks found_;
};

}  // namespace

std::vector<BodyJoint> BodyJointsOf(const JointClip& clip) {
  const Eigen::Matrix3Xd rest = clip.RestPositions();
  std::vector<BodyJoint> joints;
  for (size_t j = 0; j < clip.num_joints(); ++j) {
    const ClipJoint& joint = clip.joints[j];
    joints.push_back(
        {joint.name, joint.parent, rest.col(static_cast<Eigen::Index>(j)), joint.is_end});
  }
  return joints;
}

std::vector<BodyJoint> BodyJointsOf(const Skeleton& skeleton) {
  std::vector<BodyJoint> joints;
  for (const Joint& joint : skeleton.joints()) {
    joints.push_back({joint.name, joint.parent, joint.rest_position, false});
  }
  return joints;
}

bool Landmarks::HasLegs() const {
  return std::ranges::all_of(
      std::initializer_list<HumanJoint>{kHips, kLeftUpperLeg, kLeftLowerLeg, kLeftFoot,
                                        kRightUpperLeg, kRightLowerLeg, kRightFoot},
      [&](HumanJoint joint) { return (*this)[joint] >= 0; });
}

bool IsAtOrAbove(const std::vector<BodyJoint>& joints, int above, int joint) {
  while (joint >= 0 && joint != above) joint = joints[static_cast<size_t>(joint)].parent;
  return joint == above && above >= 0;
}

Landmarks FindLandmarks(const std::vector<BodyJoint>& joints) {
  Landmarks by_name;
  bool has_all = true;
  for (int k = 0; k < kNumHumanJoints; ++k) {
    const std::string& name = HumanTemplate().joint(k).name;
    for (size_t j = 0; j < joints.size(); ++j) {
      if (joints[j].name != name || joints[j].is_end) continue;
      by_name.joints[static_cast<size_t>(k)] = static_cast<int>(j);
      break;
    }
    has_all = has_all && by_name.joints[static_cast<size_t>(k)] >= 0;
  }
  return has_all ? by_name : LandmarkFinder(joints).Find();
}

}  // namespace pleat
