#include "pleat/mesh/normals.h"

#include <gtest/gtest.h>

#include "pleat/mesh/shapes.h"

namespace pleat {
namespace {

TEST(NormalsTest, OfASpherePointAwayFromItsCenter) {
  const MeshShape sphere = MakeUvSphere(2, 40, 80);
  const Eigen::Matrix3Xd normals = ComputeVertexNormals(sphere.topology, sphere.positions);
  for (int v = 0; v < normals.cols(); ++v) {
    EXPECT_GT(normals.col(v).dot(sphere.positions.col(v).normalized()), 0.999) << v;
    EXPECT_NEAR(normals.col(v).norm(), 1, 1e-12);
  }
}

TEST(NormalsTest, OfAGridPointUpAndLooseVerticesHaveNone) {
  const MeshShape grid = MakeGrid(2, 2, 1, 1);
  const Eigen::Matrix3Xd normals = ComputeVertexNormals(grid.topology, grid.positions);
  for (int v = 0; v < normals.cols(); ++v) EXPECT_EQ(normals.col(v), Eigen::Vector3d::UnitY());
  const Topology loose = *Topology::Create(4, {0, 1, 2}, {3});
  EXPECT_EQ(ComputeVertexNormals(loose, Eigen::Matrix3Xd::Identity(3, 4)).col(3),
            Eigen::Vector3d::Zero());
}

}  // namespace
}  // namespace pleat
