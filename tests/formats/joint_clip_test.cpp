#include "pleat/formats/joint_clip.h"

#include "formats/figure_character.h"
#include "pleat/skeleton/human_template.h"
#include "support/status_matchers.h"

namespace pleat {
namespace {

using testing::ElementsAre;
using testing::SizeIs;

TEST(JointClipTest, BonesThatBeginInOneJointHaveJointsOfTheirOwn) {
  std::vector<std::string> names;
  const std::vector<ExportJoint> joints = MakeExportJoints(HumanTemplate());
  for (const ExportJoint& joint : joints) names.push_back(joint.name);
  EXPECT_THAT(names, ElementsAre("hips", "spine_bone", "spine", "chest", "head_bone", "head",
                                 "leftUpperLeg_bone", "leftUpperLeg", "leftLowerLeg", "leftFoot",
                                 "leftToes", "rightUpperLeg_bone", "rightUpperLeg", "rightLowerLeg",
                                 "rightFoot", "rightToes", "leftUpperArm_bone", "leftUpperArm",
                                 "leftLowerArm", "leftHand", "rightUpperArm_bone", "rightUpperArm",
                                 "rightLowerArm", "rightHand"));
  // Each bone turns one joint, which rests where the bone begins.
  const std::vector<int> turning = TurningJoints(joints);
  ASSERT_THAT(turning, SizeIs(kNumHumanJoints));
  for (int b = 1; b < kNumHumanJoints; ++b) {
    EXPECT_EQ(joints[turning[b]].rest_position,
              HumanTemplate().rest_position(HumanTemplate().parent(b)))
        << b;
  }
}

TEST(JointClipTest, NamesOfBonesGiveWayToThoseOfJoints) {
  const Skeleton skeleton =
      *Skeleton::Create({{"a", -1, {0, 0, 0}}, {"b", 0, {0, 1, 0}}, {"b_bone", 0, {1, 0, 0}}});
  std::vector<std::string> names;
  for (const ExportJoint& joint : MakeExportJoints(skeleton)) names.push_back(joint.name);
  EXPECT_THAT(names, ElementsAre("a", "b_bone_", "b", "b_bone_bone", "b_bone"));
}

TEST(JointClipTest, JointsOfAClipAreWhereTheBonesAre) {
  const CharacterFile character = FigureCharacter(7);
  const Skeleton& skeleton = character.rig.skeleton;
  const JointClip clip = ClipFromPoses(skeleton, character.track);
  ASSERT_EQ(clip.num_frames(), 7u);
  EXPECT_EQ(clip.fps, character.track.fps());
  PlacedJoints placed;
  BoneTransforms bones;
  for (int t = 0; t < 7; ++t) {
    PlaceJoints(clip, static_cast<size_t>(t), &placed);
    ComputeBoneTransforms(skeleton, character.track.pose(t), {}, &bones);
    const std::vector<int> turning = TurningJoints(MakeExportJoints(skeleton));
    for (int j = 0; j < skeleton.num_joints(); ++j) {
      const int found = clip.FindJoint(skeleton.joint(j).name);
      ASSERT_GE(found, 0);
      EXPECT_LT((placed.positions.col(found) - bones.joint_positions.col(j)).norm(), 1e-12);
      EXPECT_LT((placed.rotations[turning[j]].toRotationMatrix() - bones.rotation[j]).norm(),
                1e-12);
    }
  }
}

TEST(JointClipTest, WithoutPosesTheClipRests) {
  const JointClip clip = ClipFromPoses(HumanTemplate(), {});
  ASSERT_EQ(clip.num_frames(), 1u);
  PlacedJoints placed;
  PlaceJoints(clip, 0, &placed);
  EXPECT_LT((placed.positions - clip.RestPositions()).norm(), 1e-12);
}

TEST(JointClipTest, UnitsAreGuessedFromTheSizeOfAPerson) {
  JointClip clip =
      ClipFromPoses(HumanTemplate().WithRestPositions(1.7 * HumanTemplate().RestPositions()), {});
  for (const auto& [factor, name] :
       std::vector<std::pair<double, std::string>>{{1, "meters"},
                                                   {100, "centimeters"},
                                                   {1000, "millimeters"},
                                                   {39.37, "inches"},
                                                   {3.281, "feet"},
                                                   {17.717, "units of 1/0.45 inches"}}) {
    JointClip scaled = clip;
    for (ClipJoint& joint : scaled.joints) joint.offset *= factor;
    const UnitGuess guess = GuessUnit(scaled);
    EXPECT_EQ(guess.name, name);
    EXPECT_NEAR(guess.unit_m * factor, 1, 1e-3);
    EXPECT_NEAR(guess.size * guess.unit_m, 2.3, .4);
  }
}

TEST(JointClipTest, UnitsAreNamedWithinHalfAPercent) {
  double unit_m = 0;
  EXPECT_EQ(UnitName(.010001, &unit_m), "centimeters");
  EXPECT_EQ(unit_m, .01);
  EXPECT_EQ(UnitName(.02, &unit_m), "");
  EXPECT_EQ(unit_m, .01);
}

}  // namespace
}  // namespace pleat
