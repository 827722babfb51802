#include "pleat/mesh/normals.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include "support/mesh_shapes.h"

namespace pleat {
namespace {

TEST(NormalsTest, OfASpherePointAwayFromItsCenter) {
  const MeshShape sphere = MakeUvSphere(2, 40, 80);
  const Eigen::Matrix3Xd normals =
      SumTriangleNormals(sphere.positions, sphere.topology.triangles());
  for (int v = 0; v < normals.cols(); ++v) {
    EXPECT_GT(normals.col(v).normalized().dot(sphere.positions.col(v).normalized()), 0.999) << v;
  }
}

TEST(NormalsTest, OfAGridPointUpAndLooseVerticesHaveNone) {
  const MeshShape grid = MakeGrid(2, 2, 1, 1);
  const Eigen::Matrix3Xd normals = SumTriangleNormals(grid.positions, grid.topology.triangles());
  for (int v = 0; v < normals.cols(); ++v) {
    EXPECT_EQ(normals.col(v).normalized(), Eigen::Vector3d::UnitY());
  }
  const Topology loose = *Topology::Create(4, {0, 1, 2}, {3});
  EXPECT_EQ(SumTriangleNormals(Eigen::Matrix3Xd::Identity(3, 4), loose.triangles()).col(3),
            Eigen::Vector3d::Zero());
}

// The volume inside a closed surface grows along these normals, a sixth of their length per meter.
TEST(NormalsTest, AreTheGradientOfTheVolume) {
  MeshShape box = MakeBox({1, 2, 3});
  const Eigen::Matrix3Xd normals = SumTriangleNormals(box.positions, box.topology.triangles());
  EXPECT_NEAR(normals.rowwise().sum().norm(), 0, 1e-12);
  for (double& coordinate : box.positions.reshaped()) {
    const auto volume_at = [&](double value) {
      coordinate = value;
      double volume = 0;
      for (const auto& corners : box.topology.triangles().colwise()) {
        volume += box.positions.col(corners[0])
                      .dot(Eigen::Vector3d(box.positions.col(corners[1]))
                               .cross(Eigen::Vector3d(box.positions.col(corners[2])))) /
                  6;
      }
      return volume;
    };
    const double x = coordinate, step = 1e-3;
    const double slope = (volume_at(x + step) - volume_at(x - step)) / (2 * step);
    coordinate = x;
    EXPECT_NEAR(normals.data()[&coordinate - box.positions.data()] / 6, slope, 1e-9);
  }
}

// The area vectors of a closed surface cancel, each triangle counted at its three corners.
TEST(NormalsTest, OfAClosedSurfaceAddUpToNothingAndMeasureItsArea) {
  const MeshShape box = MakeBox({1, 2, 3});
  const Eigen::Matrix3Xd normals = SumTriangleNormals(box.positions, box.topology.triangles());
  EXPECT_LT(normals.rowwise().sum().norm(), 1e-12);
  const MeshShape grid = MakeGrid(3, 4, 2, 5);
  EXPECT_NEAR(SumTriangleNormals(grid.positions, grid.topology.triangles()).row(1).sum(),
              3 * 2 * 2 * 5, 1e-12);  // three corners, twice the area
}

TEST(NormalsTest, TurnWithTheMeshAndFlipWithItsFaces) {
  const MeshShape sphere = MakeUvSphere(1, 5, 7);
  const Eigen::Matrix3Xi& triangles = sphere.topology.triangles();
  const Eigen::Matrix3d turn =
      Eigen::AngleAxisd(1, Eigen::Vector3d(1, -2, 1).normalized()).toRotationMatrix();
  const Eigen::Matrix3Xd normals = SumTriangleNormals(sphere.positions, triangles);
  EXPECT_LT((SumTriangleNormals(turn * sphere.positions, triangles) - turn * normals).norm(),
            1e-12);
  EXPECT_LT((SumTriangleNormals(sphere.positions, triangles.colwise().reverse()) + normals).norm(),
            1e-12);
  // Triangles without area add nothing.
  Eigen::Matrix3Xi more(3, triangles.cols() + 2);
  more << triangles, Eigen::Vector3i(0, 0, 1), Eigen::Vector3i(2, 2, 2);
  EXPECT_EQ(SumTriangleNormals(sphere.positions, more), normals);
}

}  // namespace
}  // namespace pleat
