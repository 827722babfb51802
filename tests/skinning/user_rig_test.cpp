#include "pleat/skinning/user_rig.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "absl/strings/str_cat.h"
#include "support/status_matchers.h"

namespace pleat {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

// hips with two legs, one of them with a foot.
Skeleton Legs() {
  return *Skeleton::Create({{"hips", -1, {0, 1, 0}},
                            {"left", 0, {.2, .9, 0}},
                            {"right", 0, {-.2, .9, 0}},
                            {"foot", 1, {.2, 0, 0}}});
}

TEST(UserRig, JointWeightsBecomeBoneWeights) {
  Eigen::Matrix3Xd positions(3, 4);
  positions << .15, -.15, .2, .2,  //
      .95, .95, .5, -.1,           //
      0, 0, 0, .1;
  PLEAT_ASSERT_OK_AND_ASSIGN(
      const UserRig rig,
      RigFromJointWeights(Legs(), {{{0, 1}}, {{0, 2}}, {{1, 3}, {3, 1}}, {{3, 1}}}, positions));
  // right moves nothing and stays as it is; foot gets an end behind the center of its vertices.
  ASSERT_EQ(rig.skeleton.num_joints(), 5);
  EXPECT_EQ(rig.skeleton.joint(4).name, "foot_end");
  EXPECT_EQ(rig.skeleton.parent(4), 3);
  const Eigen::Vector3d center =
      (Eigen::Vector3d(positions.col(2)) * .25 * 4 + Eigen::Vector3d(positions.col(3)) * 1) / 2;
  EXPECT_LT((rig.skeleton.rest_position(4) - (2 * center - Eigen::Vector3d(.2, 0, 0))).norm(),
            1e-12);
  EXPECT_EQ(rig.weights.value().vertex(0).bones[0],
            1);  // the nearer of the bones that begin in hips
  EXPECT_EQ(rig.weights.value().vertex(1).bones[0], 2);
  EXPECT_THAT(rig.weights.value().vertex(2).bones, ElementsAre(3, 4, 0, 0, 0, 0, 0, 0));
  EXPECT_THAT(rig.weights.value().vertex(2).weights, ElementsAre(.75f, .25f, 0, 0, 0, 0, 0, 0));
  EXPECT_EQ(rig.weights.value().vertex(3).bones[0], 4);
}

TEST(UserRig, SaysWhichVertexIsWrong) {
  const Eigen::Matrix3Xd positions = Eigen::Matrix3Xd::Zero(3, 2);
  const auto expect_fault = [&](std::vector<std::vector<JointInfluence>> influences,
                                const char* word) {
    EXPECT_THAT(RigFromJointWeights(Legs(), influences, positions),
                HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr(word)));
  };
  expect_fault({{{0, 1}}}, "1 vertices");
  expect_fault({{{0, 1}}, {}}, "vertex 1 has no");
  expect_fault({{{0, 1}}, {{0, 0}}}, "vertex 1 has no");
  expect_fault({{{0, 1}}, {{4, 1}}}, "joint 4");
  expect_fault({{{0, 1}}, {{-1, 1}}}, "joint -1");
  expect_fault({{{0, 1}}, {{1, -1}}}, "weight -1");
  expect_fault({{{0, 1}}, {{1, std::nan("")}}}, "nan");
}

TEST(UserRig, KeepsTheStrongestEight) {
  std::vector<Joint> joints = {{"root", -1, {0, 0, 0}}};
  for (int j = 1; j < 12; ++j) {
    joints.push_back({absl::StrCat("j", j), j - 1, {0, static_cast<double>(j), 0}});
  }
  PLEAT_ASSERT_OK_AND_ASSIGN(const UserRig rig, RigFromJointWeights(*Skeleton::Create(joints),
                                                                    {{{0, .1},
                                                                      {1, .4},
                                                                      {2, .2},
                                                                      {3, .05},
                                                                      {4, .2},
                                                                      {5, .05},
                                                                      {6, .03},
                                                                      {7, .03},
                                                                      {8, .01},
                                                                      {9, .03}}},
                                                                    Eigen::Matrix3Xd::Zero(3, 1)));
  // The weight of a joint goes to the bone that begins there.
  EXPECT_THAT(rig.weights.value().vertex(0).bones, ElementsAre(2, 3, 5, 1, 4, 6, 7, 8));
  EXPECT_FLOAT_EQ(rig.weights.value().vertex(0).weights[0], .4f / 1.06f);
}

TEST(UserRig, TooManyJointsAreRefused) {
  std::vector<Joint> joints = {{"root", -1, {0, 0, 0}}};
  std::vector<std::vector<JointInfluence>> influences;
  for (int j = 1; j < 200; ++j) {
    joints.push_back({absl::StrCat("j", j), 0, {0, static_cast<double>(j), 0}});
    influences.push_back({{j, 1}});
  }
  EXPECT_THAT(
      RigFromJointWeights(*Skeleton::Create(joints), influences, Eigen::Matrix3Xd::Random(3, 199)),
      HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("256")));
}

}  // namespace
}  // namespace pleat
