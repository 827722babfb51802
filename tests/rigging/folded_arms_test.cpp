#include "folded_arms.h"

#include <gtest/gtest.h>

#include "support/capsule_figure.h"

namespace pleat {
namespace {

// Both arms end at the elbows.
Eigen::Matrix3Xd WithoutForearms(Eigen::Matrix3Xd joints) {
  for (const int shoulder : {kLeftUpperArm, kRightUpperArm}) {
    joints.col(shoulder + 2) = joints.col(shoulder + 1);
    joints.col(shoulder + 1) = .5 * (joints.col(shoulder) + joints.col(shoulder + 2));
  }
  return joints;
}

TEST(FoldedArmsTest, ArmsUpToTheElbowFallShort) {
  for (const double leg_length : {1., .6, .45}) {
    const Eigen::Matrix3Xd joints = CapsuleFigureJoints({.leg_length = leg_length});
    EXPECT_EQ(ArmShortfall(joints, kLeftUpperArm), 0) << leg_length;
    EXPECT_FALSE(EndsEarly(joints, kRightUpperArm)) << leg_length;
    EXPECT_TRUE(EndsEarly(WithoutForearms(joints), kRightUpperArm)) << leg_length;
  }
  EXPECT_GT(ArmShortfall(WithoutForearms(CapsuleFigureJoints({})), kLeftUpperArm), .1);
}

// An elbow at the origin; a forearm of three spheres to the front, which touches the trunk; another
// one that is another chain's.
class ForearmTest : public ::testing::Test {
 protected:
  ForearmTest()
      : graph_({{{0, 0, 0}, .04},
                {{0, .02, .1}, .04},
                {{0, .03, .2}, .035},
                {{0, .04, .35}, .05},
                {{-.2, 0, .2}, .15},
                {{0, -.3, 0}, .04}},
               {{0, 1}, {1, 2}, {2, 3}, {2, 4}, {0, 4}, {0, 5}}) {}
  const Eigen::Vector3d shoulder_{0, .28, 0};
  SphereGraph graph_;
};

TEST_F(ForearmTest, IsFollowedToTheWrist) {
  const std::optional<FoldedArm> arm = FollowForearm(graph_, 0, .04, {1, 0, 0, 0, 0, 1}, shoulder_);
  ASSERT_TRUE(arm.has_value());
  EXPECT_EQ(arm->elbow, Eigen::Vector3d(0, 0, 0));
  EXPECT_NEAR(arm->hand.norm(), .97 * .28, 1e-9);
  EXPECT_LT(arm->hand.cross(Eigen::Vector3d(0, .04, .35)).norm(), 1e-9);
}

TEST_F(ForearmTest, IsNeitherTheTrunkNorAnotherChainNorTooShort) {
  EXPECT_FALSE(FollowForearm(graph_, 0, .04, {1, 1, 0, 0, 0, 1}, shoulder_).has_value());
  EXPECT_FALSE(FollowForearm(graph_, 0, .04, {1, 0, 1, 0, 0, 1}, shoulder_).has_value());
}

}  // namespace
}  // namespace pleat
