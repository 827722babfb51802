#include "foot_placement.h"

#include <gtest/gtest.h>

#include "rigging/test_bodies.h"
#include "support/capsule_figure.h"

namespace pleat {
namespace {

MainBody BodyOf(const BodyVolume& volume) {
  return FindMainBody(volume, Eigen::Matrix3d::Identity());
}

// A search ends at the tip of the foot, and refinement leaves the ankle too low.
TEST(FootPlacementTest, AnklesAndBallsFollowTheLengthOfTheFoot) {
  const CapsuleFigure figure = MakeCapsuleFigure();
  const BodyVolume volume = VolumeOf(figure.mesh);
  Eigen::Matrix3Xd joints = volume.UnitFromWorld(figure.joints);
  for (const int ankle : {kLeftFoot, kRightFoot}) {
    joints.col(ankle) -= Eigen::Vector3d(0, .01, .01);
    joints.col(ankle + 1) += Eigen::Vector3d(0, 0, .02);
  }
  const Eigen::Matrix3Xd before = joints;
  EXPECT_EQ(PlaceFeet(BodyOf(volume), &joints), (std::array<bool, 2>{true, true}));
  // The figure's foot reaches from z = -.055 to .097 of its height, and its sole is at .003.
  const double length = .152, heel = -.055, sole = .001;
  const Eigen::Matrix3Xd found = volume.WorldFromUnit(joints) / 1.7;
  for (const int ankle : {kLeftFoot, kRightFoot}) {
    EXPECT_NEAR(found(2, ankle), heel + .22 * length, .008);
    EXPECT_NEAR(found(1, ankle), sole + .33 * length, .008);
    EXPECT_NEAR(found(2, ankle + 1), heel + .74 * length, .008);
    EXPECT_NEAR(found(0, ankle + 1), figure.joints(0, ankle + 1) / 1.7, .008);
  }
  for (int j = 0; j < kNumHumanJoints; ++j) {
    const bool is_foot = j == kLeftFoot || j == kRightFoot || j == kLeftToes || j == kRightToes;
    EXPECT_EQ(joints.col(j) == before.col(j), !is_foot) << j;
  }
}

TEST(FootPlacementTest, StumpsStay) {
  const CapsuleFigure figure = MakeCapsuleFigure();
  std::vector<Capsule> parts = CapsuleFigureParts();
  std::erase_if(parts, [](const Capsule& part) { return part.end.y() < .05 && part.end.z() > .1; });
  const BodyVolume volume = VolumeOf(MakeCapsuleBody(parts, .02));
  Eigen::Matrix3Xd joints = volume.UnitFromWorld(figure.joints);
  const Eigen::Matrix3Xd before = joints;
  EXPECT_EQ(PlaceFeet(BodyOf(volume), &joints), (std::array<bool, 2>{false, false}));
  EXPECT_EQ(joints, before);
}

}  // namespace
}  // namespace pleat
