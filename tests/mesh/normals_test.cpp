#include "pleat/mesh/normals.h"

#include <gtest/gtest.h>

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

}  // namespace
}  // namespace pleat
