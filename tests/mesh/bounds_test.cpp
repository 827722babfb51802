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

}  // namespace
}  // namespace pleat
