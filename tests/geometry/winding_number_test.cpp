#include "pleat/geometry/winding_number.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <limits>

#include "pleat/base/random.h"
#include "support/test_meshes.h"
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

double ExactWinding(const Eigen::Matrix3Xd& positions, const Eigen::Matrix3Xi& triangles,
                    const Eigen::Vector3d& point) {
  const TriangleTree tree(positions, triangles);
  return WindingNumber(tree, std::numeric_limits<double>::infinity())(point);
}

// An octant of the sphere of directions, seen from both sides.
TEST(WindingNumberTest, ATriangleHasTheShareOfItsSolidAngle) {
  const Eigen::Matrix3Xd corners = Eigen::Matrix3d::Identity();
  const Eigen::Vector3i outward(0, 1, 2), inward(0, 2, 1);
  EXPECT_NEAR(ExactWinding(corners, outward, {0, 0, 0}), 1. / 8, 1e-14);
  EXPECT_NEAR(ExactWinding(corners, inward, {0, 0, 0}), -1. / 8, 1e-14);
  // Nearly in the plane it is half of everything, with the sign of the side.
  const Eigen::Vector3d middle = Eigen::Vector3d::Constant(1. / 3);
  EXPECT_NEAR(ExactWinding(corners, outward, .999999 * middle), .5, 1e-5);
  EXPECT_NEAR(ExactWinding(corners, outward, 1.000001 * middle), -.5, 1e-5);
}

// A rectangle of 2a x 2b at the distance h in front of its middle: 4 atan(ab / (h |(a, b, h)|)).
TEST(WindingNumberTest, ARectangleAgreesWithItsClosedForm) {
  for (const Eigen::Vector3d& size :
       {Eigen::Vector3d(1, 1, 1), Eigen::Vector3d(3, .2, .1), Eigen::Vector3d(.01, .02, 5)}) {
    const double a = size.x(), b = size.y(), h = size.z();
    Eigen::Matrix3Xd corners(3, 4);
    corners << -a, a, a, -a, -b, -b, b, b, h, h, h, h;
    Eigen::Matrix3Xi triangles(3, 2);
    triangles << 0, 0, 1, 2, 2, 3;
    const double angle = 4 * std::atan(a * b / (h * size.norm()));
    EXPECT_NEAR(ExactWinding(corners, triangles, {0, 0, 0}), angle / (4 * M_PI), 1e-13);
  }
}

TEST(WindingNumberTest, ClosedSurfacesCountWholeTimes) {
  const TriangleMesh box = MakeBox({0, 0, 0}, {1, 2, .5});
  EXPECT_NEAR(ExactWinding(box.positions, box.triangles, {.1, 1.9, .4}), 1, 1e-12);
  EXPECT_NEAR(ExactWinding(box.positions, box.triangles, {1.01, 1, .2}), 0, 1e-12);
  EXPECT_NEAR(ExactWinding(box.positions, box.triangles, {1e6, 0, 0}), 0, 1e-9);
  // Inside out it is minus one; a bubble in a solid is outside.
  TriangleMesh bubble = MakeBox({.4, .9, .2}, {.6, 1.1, .3});
  bubble.triangles.row(0).swap(bubble.triangles.row(1));
  EXPECT_NEAR(ExactWinding(bubble.positions, bubble.triangles, {.5, 1, .25}), -1, 1e-12);
  const TriangleMesh hollow = JoinMeshes(box, bubble);
  EXPECT_NEAR(ExactWinding(hollow.positions, hollow.triangles, {.5, 1, .25}), 0, 1e-12);
  EXPECT_NEAR(ExactWinding(hollow.positions, hollow.triangles, {.1, .1, .1}), 1, 1e-12);
}

TEST(WindingNumberTest, TheHoleOfATorusIsOutside) {
  const TestMesh torus = MakeTorus(32, 16, 1);
  const Eigen::Matrix3Xd positions = torus.positions.cast<double>();
  const Eigen::Matrix3Xi& triangles = torus.topology.triangles();
  const double sign = ExactWinding(positions, triangles, {1, 0, 0});  // within the tube
  EXPECT_NEAR(std::abs(sign), 1, 1e-6);
  EXPECT_NEAR(ExactWinding(positions, triangles, {0, 0, 0}), 0, 1e-6);
  EXPECT_NEAR(ExactWinding(positions, triangles, {0, 0, -1}), sign, 1e-6);
  EXPECT_NEAR(ExactWinding(positions, triangles, {0, .4, 0}), 0, 1e-6);
}

TEST(WindingNumberTest, NeitherMotionNorOrderNorTrianglesWithoutAreaChangeIt) {
  const TriangleMesh mesh = MakeSphere({0, 0, 0}, 1, 8);
  TriangleMesh other;
  const Eigen::Matrix3d turn =
      Eigen::AngleAxisd(2, Eigen::Vector3d(1, 1, -2).normalized()).toRotationMatrix();
  other.positions = (3 * turn * mesh.positions).colwise() + Eigen::Vector3d(1, 2, 3);
  other.triangles.resize(3, mesh.triangles.cols() + 2);
  other.triangles << Eigen::Vector3i(0, 0, 1), mesh.triangles.rowwise().reverse(),
      Eigen::Vector3i(5, 5, 5);
  Random random(3);
  for (int i = 0; i < 100; ++i) {
    const Eigen::Vector3d point(random.Normal(), random.Normal(), random.Normal());
    EXPECT_NEAR(
        ExactWinding(mesh.positions, mesh.triangles, point),
        ExactWinding(other.positions, other.triangles, 3 * turn * point + Eigen::Vector3d(1, 2, 3)),
        1e-10);
  }
}

TEST(WindingNumberTest, NothingIsOutsideOfNothing) {
  EXPECT_EQ(ExactWinding(Eigen::Matrix3Xd(3, 0), Eigen::Matrix3Xi(3, 0), {0, 0, 0}), 0);
}

}  // namespace
}  // namespace pleat
