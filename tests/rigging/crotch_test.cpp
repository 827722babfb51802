#include "crotch.h"

#include <gtest/gtest.h>

#include <cmath>

#include "pleat/rigging/body_volume.h"
#include "support/capsule_figure.h"

namespace pleat {
namespace {

// As a share of the figure's height, NAN where there is none.
double CrotchOf(const CapsuleFigureOptions& options, double hips_off = 0) {
  const CapsuleFigure figure = MakeCapsuleFigure(options);
  const BodyVolume volume =
      ComputeBodyVolume(MakeTopology(figure.mesh), figure.mesh.positions).value();
  Eigen::Matrix3Xd joints = figure.joints;
  for (const int j : {kHips, kLeftUpperLeg, kRightUpperLeg}) joints(1, j) += hips_off;
  const std::optional<double> crotch =
      CrotchHeight(volume.field, Eigen::Matrix3d::Identity(), volume.UnitFromWorld(joints),
                   volume.body->scale * options.height_m);
  if (!crotch) return std::nan("");
  return volume.WorldFromUnit(Eigen::Vector3d(0, *crotch, 0))(1, 0) / options.height_m;
}

// The figure's thighs, .055 thick, lie .055 from the middle at the hips: they meet a little lower.
TEST(CrotchTest, LiesWhereTheLegsMeet) {
  EXPECT_NEAR(CrotchOf({}), .44, .03);
  EXPECT_NEAR(CrotchOf({}, .1), CrotchOf({}), .01);  // whatever the hips were thought to be
  const double shorter = .4 * (.51 - .04);
  EXPECT_NEAR(CrotchOf({.leg_length = .6}), CrotchOf({}) - shorter, .03);
}

TEST(CrotchTest, IsNotTheHemOfASkirt) { EXPECT_TRUE(std::isnan(CrotchOf({.skirt = true}))); }

}  // namespace
}  // namespace pleat
