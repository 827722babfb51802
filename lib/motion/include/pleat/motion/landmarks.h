// Which joint of a skeleton is which part of a body (docs/method/motion.md#landmarks).
#pragma once

#include <Eigen/Core>
#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "pleat/formats/joint_clip.h"
#include "pleat/skeleton/human_template.h"
#include "pleat/skeleton/skeleton.h"

namespace pleat {

// A joint of any skeleton, with parents before children.
struct BodyJoint {
  std::string name;
  int parent = -1;
  Eigen::Vector3d rest_position = Eigen::Vector3d::Zero();  // in the world, in any unit
  bool is_end = false;                                      // a tip without motion
};
std::vector<BodyJoint> BodyJointsOf(const JointClip& clip);
std::vector<BodyJoint> BodyJointsOf(const Skeleton& skeleton);

// The joint for each joint of the human template, or -1 where there is none.
struct Landmarks {
  std::array<int, kNumHumanJoints> joints = MakeNone();

  int operator[](HumanJoint joint) const { return joints[joint]; }
  // True when the hips and both legs down to the ankles are there.
  bool HasLegs() const;

  static constexpr std::array<int, kNumHumanJoints> MakeNone() {
    std::array<int, kNumHumanJoints> none{};
    for (int& joint : none) joint = -1;
    return none;
  }
};

// Finds the limbs by the names that Mixamo, CMU, Biped, Rigify, SMPL, LaFAN, Unreal, Unity, VRM,
// Daz and Acclaim files give to their joints, and hips, spine, chest and toes by where the limbs
// branch: names of the trunk mean different places in different skeletons. A skeleton with all
// joints of the human template is taken by these names.
Landmarks FindLandmarks(const std::vector<BodyJoint>& joints);

// A name of a joint without the prefix of its package, in lower case and without digits, and its
// side: "mixamorig:LeftUpLeg" is "upleg" of side 1.
struct JointWord {
  std::string word;
  int side = 0;  // 1 left, -1 right, 0 middle
};
JointWord JointWordOf(std::string_view name);

// True when `above` is `joint` or one of its ancestors. Both may be -1, which nothing is above.
bool IsAtOrAbove(const std::vector<BodyJoint>& joints, int above, int joint);

}  // namespace pleat
