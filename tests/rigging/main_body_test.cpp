#include "main_body.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include "rigging/test_bodies.h"
#include "support/capsule_figure.h"

namespace pleat {
namespace {

TEST(MainBodyTest, WhatFloatsBesideTheCharacterIsLeftOut) {
  const TriangleMesh figure = MakeCapsuleFigure({.cell_m = .03}).mesh;
  const TriangleMesh box = MakeBox({.9, .1, -.05}, {1.0, .2, .05});  // a prop
  const BodyVolume volume = VolumeOf(JoinMeshes(figure, box));
  const MainBody body = FindMainBody(volume, Eigen::Matrix3d::Identity());
  // The box is right of everything else.
  const double box_left = volume.UnitFromWorld(Eigen::Vector3d(.9, 0, 0))(0, 0);
  EXPECT_LT(body.bounds.max().x(), box_left);
  for (const Sphere& sphere : body.graph.spheres()) EXPECT_LT(sphere.center.x(), box_left);
}

TEST(MainBodyTest, EverySphereCanBeReachedFromEveryOther) {
  const BodyVolume volume = VolumeOf(MakeCapsuleFigure({.cell_m = .03}).mesh);
  const MainBody body = FindMainBody(volume, Eigen::Matrix3d::Identity());
  ASSERT_GT(body.graph.size(), 20);
  for (int i = 0; i < body.graph.size(); ++i) {
    EXPECT_TRUE(std::isfinite(body.graph.PathLength(0, i))) << i;
  }
}

TEST(MainBodyTest, TurningStandsEverythingUpright) {
  const BodyVolume volume = VolumeOf(MakeCapsuleFigure({.cell_m = .03}).mesh);
  const Eigen::Matrix3d turn =
      Eigen::AngleAxisd(EIGEN_PI / 2, Eigen::Vector3d::UnitX()).toRotationMatrix();
  const MainBody straight = FindMainBody(volume, Eigen::Matrix3d::Identity());
  const MainBody turned = FindMainBody(volume, turn);
  EXPECT_LT((turned.shell.positions - turn * straight.shell.positions).cwiseAbs().maxCoeff(),
            1e-12);
  ASSERT_EQ(turned.graph.size(), straight.graph.size());
  for (int i = 0; i < straight.graph.size(); ++i) {
    EXPECT_LT((turned.graph.sphere(i).center - turn * straight.graph.sphere(i).center).norm(),
              1e-12);
    EXPECT_EQ(turned.graph.sphere(i).radius, straight.graph.sphere(i).radius);
  }
  EXPECT_NEAR(turned.bounds.sizes().z(), straight.bounds.sizes().y(), 1e-12);
}

TEST(MainBodyTest, TheHorizontalAxisTurnsWithTheBody) {
  const TriangleMesh slab = MakeBox({-1, 0, -.1}, {1, .5, .1});
  for (const double yaw : {0., .4, 1.2, 2.8}) {
    const Eigen::Matrix3d turn =
        Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitY()).toRotationMatrix();
    const BodyShell shell{turn * slab.positions, slab.triangles};
    EXPECT_NEAR(
        std::remainder(HorizontalAxisYaw(shell, Eigen::Matrix3d::Identity()) - yaw, EIGEN_PI), 0,
        1e-6);
  }
}

}  // namespace
}  // namespace pleat
