#include "pleat/mesh/normals.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <vector>

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

// The same directions as in double precision, in rows that leave what is between them alone.
TEST(NormalsTest, OfAFrameAreUnitLongAndKeepToTheirRows) {
  const MeshShape sphere = MakeUvSphere(1, 15, 23);
  const int num_vertices = sphere.topology.num_vertices();
  constexpr int kStride = 7;
  std::vector<float> buffer(static_cast<size_t>(kStride) * num_vertices, 5);
  Eigen::Matrix3Xf positions = sphere.positions.cast<float>();
  const VertexRows normals{.data = buffer.data() + 2, .stride = kStride};
  ComputeVertexNormals(RowsOf(&positions), num_vertices, sphere.topology.triangles(), normals);
  const Eigen::Matrix3Xd expected =
      SumTriangleNormals(sphere.positions, sphere.topology.triangles());
  for (int v = 0; v < num_vertices; ++v) {
    const Eigen::Map<Eigen::Vector3f> normal(normals.row(v));
    EXPECT_LT((normal.cast<double>() - expected.col(v).normalized()).norm(), 1e-5) << v;
    EXPECT_EQ(buffer[v * kStride + 1], 5);
    EXPECT_EQ(buffer[v * kStride + 5], 5);
  }
}

TEST(NormalsTest, OfALooseVertexIsZeroInAFrameToo) {
  const Topology loose = *Topology::Create(4, {0, 1, 2}, {3});
  Eigen::Matrix3Xf positions = Eigen::Matrix3Xf::Identity(3, 4), normals(3, 4);
  ComputeVertexNormals(RowsOf(&positions), 4, loose.triangles(), RowsOf(&normals));
  EXPECT_EQ(normals.col(3), Eigen::Vector3f::Zero());
  EXPECT_NEAR(normals.col(0).norm(), 1, 1e-6);
}

}  // namespace
}  // namespace pleat
