#include "hidden_legs.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "rigging/test_bodies.h"
#include "support/capsule_figure.h"

namespace pleat {
namespace {

bool HidesLegs(const CapsuleFigureOptions& options,
               const Eigen::Matrix3d& turn = Eigen::Matrix3d::Identity()) {
  TriangleMesh mesh = MakeCapsuleFigure(options).mesh;
  mesh.positions = turn * mesh.positions;
  const BodyVolume volume = VolumeOf(mesh);
  return AreLegsHidden(volume, FindMainBody(volume, turn.transpose()), turn.transpose());
}

TEST(HiddenLegsTest, ARobeHidesThemASkirtDoesNot) {
  for (const double hem : {.1, .14, .2}) {
    EXPECT_TRUE(HidesLegs({.robe_hem = hem, .cell_m = .03})) << hem;
  }
  EXPECT_TRUE(HidesLegs({.robe_hem = .16, .cell_m = .03}, TurnAbout({1, 2, 0}, 80)));
  EXPECT_FALSE(HidesLegs({.cell_m = .03}));
  EXPECT_FALSE(HidesLegs({.skirt = true, .cell_m = .03}));
  EXPECT_FALSE(HidesLegs({.leg_length = .5, .girth = 1.6, .cell_m = .03}));
}

TEST(HiddenLegsTest, ABellOfClothHidesThemToo) {
  EXPECT_TRUE(HidesLegs({.robe_hem = .16, .robe_is_hollow = true, .cell_m = .025}));
}

// Closed legs are one outline as well, but one that is twice as wide as deep.
TEST(HiddenLegsTest, LegsThatTouchAreSeen) {
  std::vector<Capsule> capsules = {{{0, .9, 0}, {0, 1.5, 0}, .15, .14}};
  for (const double side : {-.055, .055}) {
    capsules.push_back({{side, .9, 0}, {side, .06, 0}, .08, .058});
  }
  const BodyVolume volume = VolumeOf(MakeCapsuleBody(capsules, .025));
  EXPECT_FALSE(AreLegsHidden(volume, FindMainBody(volume, Eigen::Matrix3d::Identity()),
                             Eigen::Matrix3d::Identity()));
}

// Two large feet side by side with a trunk right above them: a cartoon, no robe.
TEST(HiddenLegsTest, FeetUnderATrunkAreSeen) {
  const auto distance = [](const Eigen::Vector3d& point) {
    const Eigen::Vector3d foot(std::abs(point.x()) - .08, point.y() - .06, point.z());
    const double feet = (foot.cwiseAbs() - Eigen::Vector3d(.07, .07, .09)).maxCoeff();
    const Eigen::Vector3d axis(0, std::clamp(point.y(), .26, .8), 0);
    return std::min(feet, (point - axis).norm() - .14);
  };
  const TriangleMesh mesh =
      PolygonizeShape(distance, {Eigen::Vector3d(-.2, -.04, -.2), Eigen::Vector3d(.2, 1, .2)}, .01);
  const BodyVolume volume = ComputeBodyVolume(MakeTopology(mesh), mesh.positions).value();
  EXPECT_FALSE(AreLegsHidden(volume, FindMainBody(volume, Eigen::Matrix3d::Identity()),
                             Eigen::Matrix3d::Identity()));
}

TEST(HiddenLegsTest, TheLegsOfTheTemplateStandUnderTheHips) {
  const CapsuleFigure figure = MakeCapsuleFigure({.robe_hem = .16, .cell_m = .03});
  const BodyVolume volume = VolumeOf(figure.mesh);
  const MainBody body = FindMainBody(volume, Eigen::Matrix3d::Identity());
  Eigen::Matrix3Xd joints = volume.UnitFromWorld(figure.joints);
  const Eigen::Matrix3Xd before = joints;
  joints.middleCols(kLeftUpperLeg, 8).setZero();
  PlaceHiddenLegs(body, body.bounds.sizes().maxCoeff() * HumanTemplate().RestPositions(), &joints);
  const double height = body.bounds.sizes().y();
  for (int j = 0; j < kNumHumanJoints; ++j) {
    const double error = (joints - before).col(j).norm() / height;
    const bool is_leg = j == kHips || (j >= kLeftUpperLeg && j <= kRightToes);
    if (is_leg) {
      EXPECT_LT(error, .06) << HumanTemplate().joint(j).name;
    } else {
      EXPECT_EQ(error, 0) << HumanTemplate().joint(j).name;
    }
  }
}

}  // namespace
}  // namespace pleat
