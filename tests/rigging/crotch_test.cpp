#include "crotch.h"

#include <gtest/gtest.h>

#include "pleat/mesh/bounds.h"
#include "pleat/rigging/body_volume.h"
#include "support/capsule_figure.h"

namespace pleat {
namespace {

// In shares of the whole figure's height; `hips_off` is how far the hips were found too high.
std::optional<Crotch> CrotchOf(const CapsuleFigureOptions& options, double hips_off = 0) {
  const CapsuleFigure figure = MakeCapsuleFigure(options);
  const BodyVolume volume =
      ComputeBodyVolume(MakeTopology(figure.mesh), figure.mesh.positions).value();
  Eigen::Matrix3Xd joints = figure.joints;
  for (const int j : {kHips, kLeftUpperLeg, kRightUpperLeg}) {
    joints(1, j) += hips_off * options.height_m;
  }
  std::optional<Crotch> crotch =
      FindCrotch(volume.field, Eigen::Matrix3d::Identity(), volume.UnitFromWorld(joints),
                 ComputeBounds(volume.body->shell.positions));
  if (!crotch) return crotch;
  for (double* height : {&crotch->height, &crotch->hips}) {
    *height = volume.WorldFromUnit(Eigen::Vector3d(0, *height, 0))(1, 0) / options.height_m;
  }
  return crotch;
}

// The figure's thighs, .055 thick, lie .055 from the middle at the hips: they meet a little lower.
TEST(CrotchTest, LiesWhereTheLegsMeet) {
  const std::optional<Crotch> crotch = CrotchOf({});
  ASSERT_TRUE(crotch.has_value());
  EXPECT_NEAR(crotch->height, .44, .03);
  EXPECT_NEAR(crotch->hips, .51, .04);
  // Whatever the hips were thought to be.
  EXPECT_NEAR(CrotchOf({}, .1).value().height, crotch->height, .01);
  const double shorter = .4 * (.51 - .04);
  EXPECT_NEAR(CrotchOf({.leg_length = .6}).value().height, crotch->height - shorter, .03);
}

TEST(CrotchTest, IsNotTheHemOfASkirt) {
  EXPECT_FALSE(CrotchOf({.skirt = true, .cell_m = .025}).has_value());
}

// The legs part low, and far below the hips that the proportions of people make: a belly hangs
// there. Its hips are in it, not at its bottom.
TEST(CrotchTest, LiesUnderABelly) {
  for (const double girth : {1.4, 1.8}) {
    const CapsuleFigureOptions fat = {.leg_length = .4, .girth = girth, .cell_m = .025};
    const std::optional<Crotch> crotch = CrotchOf(fat, .12);
    ASSERT_TRUE(crotch.has_value()) << girth;
    EXPECT_NEAR(crotch->hips, CapsuleFigureJoints(fat)(1, kLeftUpperLeg), .05) << girth;
  }
}

// Legs that touch from the knees on are no low crotch.
TEST(CrotchTest, IsNotWhereLegsTouch) {
  std::vector<Capsule> capsules = {{{0, .9, 0}, {0, 1.5, 0}, .15, .14}};
  CapsuleFigure figure = MakeCapsuleFigure({.cell_m = .05});
  for (const int hip : {kLeftUpperLeg, kRightUpperLeg}) {
    const double side = hip == kLeftUpperLeg ? 1 : -1;
    figure.joints.col(hip) << side * .07, .87, 0;
    figure.joints.col(hip + 1) << side * .06, .45, 0;
    figure.joints.col(hip + 2) << side * .09, .07, 0;
    capsules.push_back({figure.joints.col(hip), figure.joints.col(hip + 1), .08, .07});
    capsules.push_back({figure.joints.col(hip + 1), figure.joints.col(hip + 2), .07, .05});
  }
  const TriangleMesh mesh = MakeCapsuleBody(capsules, .02);
  const BodyVolume volume = ComputeBodyVolume(MakeTopology(mesh), mesh.positions).value();
  EXPECT_FALSE(FindCrotch(volume.field, Eigen::Matrix3d::Identity(),
                          volume.UnitFromWorld(figure.joints),
                          ComputeBounds(volume.body->shell.positions))
                   .has_value());
}

}  // namespace
}  // namespace pleat
