#include "pleat/mesh/bounds.h"

#include <gtest/gtest.h>

#include "support/mesh_shapes.h"

namespace pleat {
namespace {

TEST(BoundsTest, OfABox) {
  const MeshShape box = MakeBox({2, 3, 6});
  const Eigen::AlignedBox3d bounds = ComputeBounds(box.positions);
  EXPECT_EQ(bounds.min(), Eigen::Vector3d(-1, -1.5, -3));
  EXPECT_EQ(bounds.max(), Eigen::Vector3d(1, 1.5, 3));
  EXPECT_DOUBLE_EQ(BoundsDiagonal(box.positions), 7);
}

TEST(BoundsTest, OfOnePointAndOfPointsInAnyOrder) {
  const Eigen::Vector3d point(3, -4, 5);
  EXPECT_EQ(ComputeBounds(point).min(), point);
  EXPECT_EQ(ComputeBounds(point).max(), point);
  EXPECT_EQ(BoundsDiagonal(point), 0);
  const MeshShape sphere = MakeUvSphere(2, 9, 12);
  const Eigen::Matrix3Xd shifted = sphere.positions.colwise() + point;
  EXPECT_NEAR(BoundsDiagonal(shifted), BoundsDiagonal(sphere.positions), 1e-12);
  EXPECT_EQ(BoundsDiagonal(shifted.rowwise().reverse()), BoundsDiagonal(shifted));
  EXPECT_LT((ComputeBounds(shifted).center() - point).norm(), 1e-12);
}

}  // namespace
}  // namespace pleat
