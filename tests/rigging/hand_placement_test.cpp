#include "hand_placement.h"

#include <gtest/gtest.h>

#include "support/capsule_figure.h"

namespace pleat {
namespace {

constexpr int kShoulders[] = {kLeftUpperArm, kRightUpperArm};

class HandPlacementTest : public testing::Test {
 protected:
  const CapsuleFigure figure_ = MakeCapsuleFigure({.cell_m = .025});
  const BodyVolume volume_ =
      ComputeBodyVolume(MakeTopology(figure_.mesh), figure_.mesh.positions, {.resolution = 64})
          .value();
  const MainBody body_ = FindMainBody(volume_, Eigen::Matrix3d::Identity());
  const double body_size_ = body_.bounds.sizes().maxCoeff();

  Eigen::Matrix3Xd UnitJoints() const { return volume_.UnitFromWorld(figure_.joints); }
};

// A search ends at the last sphere of the limb, near the tip of the fingers.
TEST_F(HandPlacementTest, AHandAtTheTipMovesBackToFourFifthsOfTheArm) {
  Eigen::Matrix3Xd joints = UnitJoints();
  for (const int shoulder : kShoulders) {
    const Eigen::Vector3d fore = joints.col(shoulder + 2) - joints.col(shoulder + 1);
    joints.col(shoulder + 2) += .25 * fore;  // the figure's own tip
  }
  const Eigen::Matrix3Xd before = joints;
  PlaceHands(body_, body_size_, &joints);
  for (const int shoulder : kShoulders) {
    const double arm = (before.col(shoulder + 1) - before.col(shoulder)).norm() +
                       (before.col(shoulder + 2) - before.col(shoulder + 1)).norm();
    const double placed = (joints.col(shoulder + 1) - joints.col(shoulder)).norm() +
                          (joints.col(shoulder + 2) - joints.col(shoulder + 1)).norm();
    EXPECT_LT(placed, .9 * arm);
    EXPECT_GT(placed, .75 * arm);
    // The elbow is halfway, as in the template.
    EXPECT_NEAR((joints.col(shoulder + 1) - joints.col(shoulder)).norm(), .5 * placed,
                .02 * placed);
  }
}

TEST_F(HandPlacementTest, OtherJointsStayAndAHandThatLiesBeforeStays) {
  Eigen::Matrix3Xd joints = UnitJoints();
  for (const int shoulder : kShoulders) {
    const Eigen::Vector3d fore = joints.col(shoulder + 2) - joints.col(shoulder + 1);
    joints.col(shoulder + 2) -= .4 * fore;  // halfway up the forearm
  }
  const Eigen::Matrix3Xd before = joints;
  PlaceHands(body_, body_size_, &joints);
  EXPECT_EQ(joints, before);
}

TEST_F(HandPlacementTest, OnlyArmsMove) {
  Eigen::Matrix3Xd joints = UnitJoints();
  const Eigen::Matrix3Xd before = joints;
  PlaceHands(body_, body_size_, &joints);
  for (int j = 0; j < kNumHumanJoints; ++j) {
    const bool is_arm =
        j == kLeftLowerArm || j == kLeftHand || j == kRightLowerArm || j == kRightHand;
    if (!is_arm) {
      EXPECT_EQ(joints.col(j), before.col(j)) << j;
    }
  }
}

}  // namespace
}  // namespace pleat
