#include "pleat/motion/default_joint_map.h"

#include <gmock/gmock.h>

#include "pleat/skeleton/human_template.h"
#include "support/status_matchers.h"

namespace pleat {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;

JointClip MakeClip(const std::vector<std::tuple<const char*, int, Eigen::Vector3d>>& joints) {
  JointClip clip;
  for (const auto& [name, parent, offset] : joints) {
    clip.joints.push_back({.name = name, .parent = parent, .offset = offset});
    clip.rotations.push_back(Eigen::Quaterniond::Identity());
    clip.translations.push_back(offset);
  }
  return clip;
}

JointClip Legs() {
  return MakeClip({{"Hips", -1, {0, 1, 0}},
                   {"LeftUpLeg", 0, {.1, 0, 0}},
                   {"LeftLeg", 1, {0, -.4, 0}},
                   {"LeftFoot", 2, {0, -.4, 0}},
                   {"RightUpLeg", 0, {-.1, 0, 0}},
                   {"RightLeg", 4, {0, -.4, 0}},
                   {"RightFoot", 5, {0, -.4, 0}},
                   {"Tail", 0, {0, 0, -.2}}});
}

TEST(DefaultJointMapTest, LandmarksAreMappedAndOthersLeftOut) {
  PLEAT_ASSERT_OK_AND_ASSIGN(const JointMap map, MakeJointMap(Legs(), HumanTemplate()));
  ASSERT_EQ(map.joints.size(), 18u);
  const JointMapEntry& shank = map.joints[kLeftFoot];
  EXPECT_EQ(shank.joint, "leftFoot");
  EXPECT_EQ(shank.from, "LeftFoot");
  EXPECT_EQ(shank.turns_with, "LeftLeg");
  EXPECT_EQ(shank.alignment, BoneAlignment::kDirection);
  EXPECT_EQ(map.joints[kLeftUpperLeg].turns_with, "Hips");
  EXPECT_EQ(map.joints[kHead].from, "");
  EXPECT_THAT(map.left_out, ElementsAre("Tail"));
}

TEST(DefaultJointMapTest, ABodyWithoutLegsIsRefusedWithItsJoints) {
  JointClip clip = Legs();
  clip.joints[3].name = "Wheel";
  EXPECT_THAT(MakeJointMap(clip, HumanTemplate()),
              HasStatus(kInvalid, AllOf(HasSubstr("leftFoot"), HasSubstr("Wheel"),
                                        HasSubstr("pleat motion map"))));
}

TEST(DefaultJointMapTest, ResolvedBonesBeginWhereTheNextMappedBoneEnds) {
  PLEAT_ASSERT_OK_AND_ASSIGN(JointMap map, MakeJointMap(Legs(), HumanTemplate()));
  map.joints[kLeftLowerLeg].from.clear();
  map.joints[kLeftLowerLeg].turns_with.clear();
  map.joints[kLeftFoot].turns_with.clear();
  PLEAT_ASSERT_OK_AND_ASSIGN(const std::vector<ResolvedBone> bones,
                             ResolveJointMap(map, Legs(), HumanTemplate()));
  ASSERT_EQ(bones.size(), 6u);
  EXPECT_EQ(bones[0].bone, kHips);
  EXPECT_EQ(bones[2].bone, kLeftFoot);
  EXPECT_EQ(bones[2].begin, 1);  // LeftUpLeg
  EXPECT_EQ(bones[2].turns, 2);  // the joint above, where the map does not say
}

}  // namespace
}  // namespace pleat
