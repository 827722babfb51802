#include "pleat/skeleton/human_template.h"

#include <gtest/gtest.h>

namespace pleat {
namespace {

TEST(HumanTemplateTest, HasTheJointsOfThePaper) {
  const Skeleton& skeleton = HumanTemplate();
  ASSERT_EQ(skeleton.num_joints(), kNumHumanJoints);
  EXPECT_EQ(skeleton.joint(kHips).name, "hips");
  EXPECT_EQ(skeleton.joint(kRightHand).name, "rightHand");
  EXPECT_EQ(skeleton.parent(kLeftUpperArm), kChest);
  EXPECT_EQ(skeleton.parent(kRightUpperLeg), kHips);
  for (int j = 0; j < kNumHumanJoints; ++j) {
    EXPECT_EQ(skeleton.FindJoint(skeleton.joint(j).name), j);
  }
}

TEST(HumanTemplateTest, IsSymmetricUnderTheMirror) {
  const Skeleton& skeleton = HumanTemplate();
  const auto& mirror = HumanMirror();
  for (int j = 0; j < kNumHumanJoints; ++j) {
    EXPECT_EQ(mirror[mirror[j]], j);
    if (j > 0) {
      EXPECT_EQ(mirror[skeleton.parent(j)], skeleton.parent(mirror[j])) << "joint " << j;
    }
    const Eigen::Vector3d p = skeleton.rest_position(j), q = skeleton.rest_position(mirror[j]);
    EXPECT_EQ(q, Eigen::Vector3d(-p.x(), p.y(), p.z())) << "joint " << j;
    // Left is +x.
    const std::string& name = skeleton.joint(j).name;
    if (name.starts_with("left")) {
      EXPECT_GT(p.x(), 0);
    } else if (!name.starts_with("right")) {
      EXPECT_EQ(mirror[j], j);
    }
  }
}

TEST(HumanTemplateTest, StandsOnTheFloorOneHigh) {
  const Eigen::Matrix3Xd joints = HumanTemplate().RestPositions();
  EXPECT_GT(joints.row(1).minCoeff(), 0);
  EXPECT_LT(joints.row(1).maxCoeff(), 1);
  EXPECT_GT(joints(2, kLeftToes), joints(2, kLeftFoot));  // faces +z
}

}  // namespace
}  // namespace pleat
