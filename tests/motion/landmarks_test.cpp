#include "pleat/motion/landmarks.h"

#include <gtest/gtest.h>

#include <map>

namespace pleat {
namespace {

// "name parent" for each joint; an end has the name of its parent and "_end".
using Bones = std::vector<std::pair<std::string, std::string>>;

std::vector<BodyJoint> MakeBody(const Bones& bones) {
  std::vector<BodyJoint> joints;
  std::map<std::string, int> index;
  for (const auto& [name, parent] : bones) {
    BodyJoint joint{.name = name, .parent = parent.empty() ? -1 : index.at(parent)};
    joint.rest_position = Eigen::Vector3d(1, 2, 3) * static_cast<double>(joints.size());
    joint.is_end = name.ends_with("_end");
    index[name] = static_cast<int>(joints.size());
    joints.push_back(joint);
  }
  return joints;
}

void ExpectLandmarks(const Bones& bones, const std::map<HumanJoint, std::string>& expected) {
  const std::vector<BodyJoint> joints = MakeBody(bones);
  const Landmarks found = FindLandmarks(joints);
  for (const auto& [landmark, name] : expected) {
    const int joint = found[landmark];
    EXPECT_EQ(joint < 0 ? "" : joints[static_cast<size_t>(joint)].name, name)
        << HumanTemplate().joint(landmark).name;
  }
}

// The shoulder is the upper arm, and the hip the thigh.
TEST(LandmarksTest, CmuOfTheYears) {
  ExpectLandmarks({{"Hips", ""},
                   {"LHipJoint", "Hips"},
                   {"LeftHip", "LHipJoint"},
                   {"LeftKnee", "LeftHip"},
                   {"LeftAnkle", "LeftKnee"},
                   {"LeftToe", "LeftAnkle"},
                   {"RHipJoint", "Hips"},
                   {"RightHip", "RHipJoint"},
                   {"RightKnee", "RightHip"},
                   {"RightAnkle", "RightKnee"},
                   {"RightAnkle_end", "RightAnkle"},
                   {"lowerback", "Hips"},
                   {"Chest", "lowerback"},
                   {"Chest2", "Chest"},
                   {"Neck", "Chest2"},
                   {"Head", "Neck"},
                   {"LeftCollar", "Chest2"},
                   {"LeftShoulder", "LeftCollar"},
                   {"LeftElbow", "LeftShoulder"},
                   {"LeftWrist", "LeftElbow"},
                   {"lhand", "LeftWrist"},
                   {"RightCollar", "Chest2"},
                   {"RightShoulder", "RightCollar"},
                   {"RightElbow", "RightShoulder"},
                   {"RightWrist", "RightElbow"}},
                  {{kHips, "Hips"},
                   {kLeftUpperLeg, "LeftHip"},
                   {kLeftFoot, "LeftAnkle"},
                   {kLeftToes, "LeftToe"},
                   {kRightToes, "RightAnkle_end"},
                   {kSpine, "Chest"},
                   {kChest, "Chest2"},
                   {kHead, "Head"},
                   {kLeftUpperArm, "LeftShoulder"},
                   {kLeftLowerArm, "LeftElbow"},
                   {kLeftHand, "LeftWrist"},
                   {kRightUpperArm, "RightShoulder"}});
}

// The shoulder is the collar bone, and the leg the shank.
TEST(LandmarksTest, MixamoAndLafan) {
  ExpectLandmarks({{"mixamorig:Hips", ""},
                   {"mixamorig:Spine", "mixamorig:Hips"},
                   {"mixamorig:Spine1", "mixamorig:Spine"},
                   {"mixamorig:Spine2", "mixamorig:Spine1"},
                   {"mixamorig:Head", "mixamorig:Spine2"},
                   {"mixamorig:LeftShoulder", "mixamorig:Spine2"},
                   {"mixamorig:LeftArm", "mixamorig:LeftShoulder"},
                   {"mixamorig:LeftForeArm", "mixamorig:LeftArm"},
                   {"mixamorig:LeftHand", "mixamorig:LeftForeArm"},
                   {"mixamorig:RightShoulder", "mixamorig:Spine2"},
                   {"mixamorig:RightArm", "mixamorig:RightShoulder"},
                   {"mixamorig:RightForeArm", "mixamorig:RightArm"},
                   {"mixamorig:RightHand", "mixamorig:RightForeArm"},
                   {"mixamorig:LeftUpLeg", "mixamorig:Hips"},
                   {"mixamorig:LeftLeg", "mixamorig:LeftUpLeg"},
                   {"mixamorig:LeftFoot", "mixamorig:LeftLeg"},
                   {"mixamorig:LeftToeBase", "mixamorig:LeftFoot"},
                   {"mixamorig:RightUpLeg", "mixamorig:Hips"},
                   {"mixamorig:RightLeg", "mixamorig:RightUpLeg"},
                   {"mixamorig:RightFoot", "mixamorig:RightLeg"}},
                  {{kSpine, "mixamorig:Spine1"},
                   {kChest, "mixamorig:Spine2"},
                   {kLeftUpperArm, "mixamorig:LeftArm"},
                   {kLeftUpperLeg, "mixamorig:LeftUpLeg"},
                   {kLeftLowerLeg, "mixamorig:LeftLeg"},
                   {kLeftToes, "mixamorig:LeftToeBase"},
                   {kRightToes, ""}});
}

// The foot holds the toes.
TEST(LandmarksTest, Smpl) {
  ExpectLandmarks({{"Pelvis", ""},
                   {"L_Hip", "Pelvis"},
                   {"L_Knee", "L_Hip"},
                   {"L_Ankle", "L_Knee"},
                   {"L_Foot", "L_Ankle"},
                   {"R_Hip", "Pelvis"},
                   {"R_Knee", "R_Hip"},
                   {"R_Ankle", "R_Knee"},
                   {"R_Foot", "R_Ankle"},
                   {"Spine1", "Pelvis"},
                   {"Spine2", "Spine1"},
                   {"Spine3", "Spine2"},
                   {"Neck", "Spine3"},
                   {"Head", "Neck"},
                   {"L_Collar", "Spine3"},
                   {"L_Shoulder", "L_Collar"},
                   {"L_Elbow", "L_Shoulder"},
                   {"L_Wrist", "L_Elbow"},
                   {"L_Hand", "L_Wrist"},
                   {"R_Collar", "Spine3"},
                   {"R_Shoulder", "R_Collar"},
                   {"R_Elbow", "R_Shoulder"},
                   {"R_Wrist", "R_Elbow"}},
                  {{kHips, "Pelvis"},
                   {kLeftFoot, "L_Ankle"},
                   {kLeftToes, "L_Foot"},
                   {kLeftUpperArm, "L_Shoulder"},
                   {kLeftHand, "L_Wrist"},
                   {kChest, "Spine3"},
                   {kSpine, "Spine2"}});
}

// The hips are a bone that is called spine, and those of Biped hang below a root.
TEST(LandmarksTest, RigifyAndBiped) {
  ExpectLandmarks({{"root", ""},
                   {"spine", "root"},
                   {"spine.001", "spine"},
                   {"spine.003", "spine.001"},
                   {"spine.006", "spine.003"},
                   {"shoulder.L", "spine.003"},
                   {"upper_arm.L", "shoulder.L"},
                   {"forearm.L", "upper_arm.L"},
                   {"hand.L", "forearm.L"},
                   {"shoulder.R", "spine.003"},
                   {"upper_arm.R", "shoulder.R"},
                   {"forearm.R", "upper_arm.R"},
                   {"hand.R", "forearm.R"},
                   {"thigh.L", "spine"},
                   {"shin.L", "thigh.L"},
                   {"foot.L", "shin.L"},
                   {"toe.L", "foot.L"},
                   {"thigh.R", "spine"},
                   {"shin.R", "thigh.R"},
                   {"foot.R", "shin.R"},
                   {"toe.R", "foot.R"}},
                  {{kHips, "spine"},
                   {kChest, "spine.003"},
                   {kSpine, "spine.001"},
                   {kLeftLowerLeg, "shin.L"},
                   {kRightHand, "hand.R"},
                   {kRightToes, "toe.R"}});
  ExpectLandmarks({{"Bip01", ""},
                   {"Bip01 Pelvis", "Bip01"},
                   {"Bip01 Spine", "Bip01 Pelvis"},
                   {"Bip01 L Thigh", "Bip01 Pelvis"},
                   {"Bip01 L Calf", "Bip01 L Thigh"},
                   {"Bip01 L Foot", "Bip01 L Calf"},
                   {"Bip01 L Toe0", "Bip01 L Foot"},
                   {"Bip01 R Thigh", "Bip01 Pelvis"},
                   {"Bip01 R Calf", "Bip01 R Thigh"},
                   {"Bip01 R Foot", "Bip01 R Calf"},
                   {"Bip01 Head", "Bip01 Spine"}},
                  {{kHips, "Bip01 Pelvis"},
                   {kLeftUpperLeg, "Bip01 L Thigh"},
                   {kRightFoot, "Bip01 R Foot"},
                   {kLeftToes, "Bip01 L Toe0"},
                   {kLeftUpperArm, ""},
                   {kHead, "Bip01 Head"}});
}

TEST(LandmarksTest, TheTemplateIsItself) {
  const Landmarks found = FindLandmarks(BodyJointsOf(HumanTemplate()));
  for (int k = 0; k < kNumHumanJoints; ++k) EXPECT_EQ(found.joints[static_cast<size_t>(k)], k);
  EXPECT_TRUE(found.HasLegs());
}

TEST(LandmarksTest, NoBodyHasNone) {
  const Landmarks found = FindLandmarks(MakeBody({{"a", ""}, {"b", "a"}, {"LeftLeg", "b"}}));
  EXPECT_FALSE(found.HasLegs());
  for (const int joint : found.joints) EXPECT_EQ(joint, -1);
  EXPECT_FALSE(FindLandmarks({}).HasLegs());
}

}  // namespace
}  // namespace pleat
