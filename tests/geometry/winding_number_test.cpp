#include "pleat/geometry/winding_number.h"

#include <gtest/gtest.h>

#include <limits>

#include "pleat/base/random.h"
#include "support/triangle_shapes.h"

namespace pleat {
namespace {

TEST(WindingNumberTest, TellsInsideFromOutsideOfASphere) {
  const TriangleMesh mesh = MakeSphere({1, 2, 3}, 1, 20);
  const TriangleTree tree(mesh.positions, mesh.triangles);
  const WindingNumber winding_number(tree);
  Random random(1);
  for (int i = 0; i < 500; ++i) {
    const Eigen::Vector3d direction =
        Eigen::Vector3d(random.Normal(), random.Normal(), random.Normal()).normalized();
    const double inner = random.Uniform(0, .93), outer = random.Uniform(1.05, 5);
    EXPECT_NEAR(winding_number(Eigen::Vector3d(1, 2, 3) + inner * direction), 1, .06);
    EXPECT_NEAR(winding_number(Eigen::Vector3d(1, 2, 3) + outer * direction), 0, .06);
  }
}

TEST(WindingNumberTest, ApproximationStaysNearTheExactSum) {
  const TriangleMesh mesh = MakeCapsuleQuadruped(.08);
  const TriangleTree tree(mesh.positions, mesh.triangles);
  const WindingNumber approximate(tree), exact(tree, std::numeric_limits<double>::infinity());
  Random random(2);
  for (int i = 0; i < 500; ++i) {
    const Eigen::Vector3d point(random.Uniform(-1, 1), random.Uniform(0, 2),
                                random.Uniform(-1.5, 1.5));
    EXPECT_NEAR(approximate(point), exact(point), .06);
  }
}

TEST(WindingNumberTest, HoleLeavesTheSidesTellable) {
  TriangleMesh mesh = MakeSphere({0, 0, 0}, 1, 20);
  int kept = 0;  // cut a cap off the top
  for (int f = 0; f < mesh.triangles.cols(); ++f) {
    if (mesh.positions(1, mesh.triangles(0, f)) < .8)
      mesh.triangles.col(kept++) = mesh.triangles.col(f);
  }
  ASSERT_LT(kept, mesh.triangles.cols());
  mesh.triangles.conservativeResize(3, kept);
  const TriangleTree tree(mesh.positions, mesh.triangles);
  const WindingNumber winding_number(tree);
  EXPECT_TRUE(winding_number.IsInside({0, 0, 0}));
  EXPECT_TRUE(winding_number.IsInside({0, -.9, 0}));
  EXPECT_TRUE(winding_number.IsInside({.5, .5, .5}));
  EXPECT_FALSE(winding_number.IsInside({0, 1.2, 0}));
  EXPECT_FALSE(winding_number.IsInside({1.1, 0, 0}));
}

TEST(WindingNumberTest, OverlappingBoxesCountTwice) {
  const TriangleMesh mesh =
      JoinMeshes(MakeBox({0, 0, 0}, {2, 1, 1}), MakeBox({1, 0, 0}, {3, 1, 1}));
  const TriangleTree tree(mesh.positions, mesh.triangles);
  const WindingNumber winding_number(tree);
  EXPECT_NEAR(winding_number({.5, .5, .5}), 1, .06);
  EXPECT_NEAR(winding_number({1.5, .5, .5}), 2, .06);
  EXPECT_NEAR(winding_number({3.5, .5, .5}), 0, .06);
}

}  // namespace
}  // namespace pleat
