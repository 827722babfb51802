#include "bone_joints.h"

#include "formats/figure_character.h"
#include "pleat/formats/joint_clip.h"
#include "support/status_matchers.h"

namespace pleat {
namespace {

// The export joints of a skeleton as a rig file: the k-th vertex moves with the k-th joint that
// turns.
RigFile ExportedRig(const Skeleton& skeleton) {
  RigFile file;
  std::vector<Joint> joints;
  for (const ExportJoint& joint : MakeExportJoints(skeleton)) {
    joints.push_back({joint.name, joint.parent, joint.rest_position});
  }
  const std::vector<int> turning = TurningJoints(MakeExportJoints(skeleton));
  for (size_t b = 1; b < turning.size(); ++b) file.influences.push_back({{turning[b], 1}});
  file.skeleton = *Skeleton::Create(std::move(joints));
  return file;
}

std::vector<int> InOrder(const RigFile& file) {
  std::vector<int> places(static_cast<size_t>(file.skeleton.num_joints()));
  for (size_t j = 0; j < places.size(); ++j) places[j] = static_cast<int>(j);
  return places;
}

TEST(BoneJointsTest, TheSkeletonAndItsBonesComeBack) {
  const Skeleton skeleton = FigureCharacter(0).rig.skeleton;
  RigFile file = ExportedRig(skeleton);
  TakeBoneJoints(InOrder(file), &file);
  ASSERT_EQ(file.skeleton.num_joints(), skeleton.num_joints());
  EXPECT_TRUE(file.influences_are_of_bones);
  for (int j = 0; j < skeleton.num_joints(); ++j) {
    EXPECT_EQ(file.skeleton.joint(j).name, skeleton.joint(j).name);
    EXPECT_EQ(file.skeleton.parent(j), skeleton.parent(j));
    if (j > 0) {
      EXPECT_EQ(file.influences[j - 1][0].joint, j);
    }
  }
}

TEST(BoneJointsTest, AnotherOrderOfTheSkinKeepsParentsFirst) {
  RigFile file = ExportedRig(FigureCharacter(0).rig.skeleton);
  std::vector<int> places = InOrder(file);
  std::reverse(places.begin(), places.end());
  TakeBoneJoints(places, &file);
  EXPECT_EQ(file.skeleton.num_joints(), 18);
}

TEST(BoneJointsTest, ARigStaysWhereItsWeightsDoNotSayWhichBoneIsMeant) {
  for (const char* name : {"chest", "hips", "head"}) {
    RigFile file = ExportedRig(FigureCharacter(0).rig.skeleton);
    file.influences[3] = {{file.skeleton.FindJoint(name), 1}};
    TakeBoneJoints(InOrder(file), &file);
    EXPECT_EQ(file.skeleton.num_joints(), 24) << name;
    EXPECT_FALSE(file.influences_are_of_bones);
  }
}

TEST(BoneJointsTest, JointsThatAreOnlyCalledLikeThatStay) {
  RigFile file;
  file.skeleton =
      *Skeleton::Create({{"a", -1, {0, 0, 0}}, {"b_bone", 0, {0, 1, 0}}, {"b", 1, {0, 2, 0}}});
  file.influences = {{{0, 1}}};
  TakeBoneJoints({0, 1, 2}, &file);
  EXPECT_EQ(file.skeleton.num_joints(), 3);  // it lies elsewhere than the joint above
}

}  // namespace
}  // namespace pleat
