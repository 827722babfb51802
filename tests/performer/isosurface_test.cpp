#include "isosurface.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "performer/soup_checks.h"
#include "support/status_matchers.h"

namespace pleat {
namespace {

using Eigen::Vector3d;

const Vector3d kLow(-1.6, -1.6, -1.6), kHigh(1.6, 1.6, 1.6);

TEST(IsosurfaceTest, ASphereIsClosedOutwardAndOfItsVolume) {
  double last_error = 10;
  for (const double spacing : {.3, .15, .075}) {
    PLEAT_ASSERT_OK_AND_ASSIGN(const TriangleSoup soup,
                               ExtractIsosurface(Sphere, kLow, kHigh, spacing, {}));
    EXPECT_TRUE(IsClosedManifold(soup));
    EXPECT_EQ(EulerCharacteristic(soup), 2);
    const double error = std::abs(Volume(soup) - 4 / 3. * std::numbers::pi);
    EXPECT_LT(error, last_error / 2.5) << spacing;  // second order in the spacing
    last_error = error;
    for (const Vector3d& p : soup.positions) EXPECT_NEAR(p.norm(), 1, .3 * spacing);
  }
}

TEST(IsosurfaceTest, ATorusKeepsItsHole) {
  PLEAT_ASSERT_OK_AND_ASSIGN(const TriangleSoup soup,
                             ExtractIsosurface(Torus, kLow, kHigh, .1, {}));
  EXPECT_TRUE(IsClosedManifold(soup));
  EXPECT_EQ(EulerCharacteristic(soup), 0);
  EXPECT_GT(Volume(soup), 0);
}

// Surfaces through grid points are the degenerate case: values of exactly zero.
TEST(IsosurfaceTest, SurfacesThroughGridPointsStayManifold) {
  const auto cube = [](const Vector3d& p) { return p.cwiseAbs().maxCoeff() - 1; };
  PLEAT_ASSERT_OK_AND_ASSIGN(const TriangleSoup soup, ExtractIsosurface(cube, Vector3d(-2, -2, -2),
                                                                        Vector3d(2, 2, 2), .5, {}));
  EXPECT_TRUE(IsClosedManifold(soup));
  EXPECT_EQ(EulerCharacteristic(soup), 2);
  EXPECT_NEAR(Volume(soup), 8, 2);  // cells of half a unit cut the edges off
}

TEST(IsosurfaceTest, NothingInsideIsNoTriangle) {
  PLEAT_ASSERT_OK_AND_ASSIGN(
      const TriangleSoup soup,
      ExtractIsosurface([](const Vector3d&) { return 1.0; }, kLow, kHigh, .4, {}));
  EXPECT_TRUE(soup.positions.empty());
  EXPECT_TRUE(soup.triangles.empty());
}

TEST(IsosurfaceTest, CancellationIsHeard) {
  EXPECT_THAT(ExtractIsosurface(Sphere, kLow, kHigh, .1, Progress(nullptr, [] { return true; })),
              HasStatus(absl::StatusCode::kCancelled, testing::_));
}

// Two balls, one of them beyond the other's reach: every part of the surface is closed in itself.
TEST(IsosurfaceTest, SeparatePartsAreSeparateSurfaces) {
  const auto two_balls = [](const Vector3d& p) {
    return std::min((p - Vector3d(-.7, 0, 0)).norm() - .4, (p - Vector3d(.7, .2, 0)).norm() - .5);
  };
  PLEAT_ASSERT_OK_AND_ASSIGN(const TriangleSoup soup,
                             ExtractIsosurface(two_balls, kLow, kHigh, .08, {}));
  EXPECT_TRUE(IsClosedManifold(soup));
  EXPECT_EQ(EulerCharacteristic(soup), 4);  // twice that of a sphere
  const double expected = 4 / 3. * std::numbers::pi * (.4 * .4 * .4 + .5 * .5 * .5);
  EXPECT_NEAR(Volume(soup), expected, .05 * expected);
}

// Neither where the grid lies nor how the solid is turned decides what comes out.
TEST(IsosurfaceTest, ATurnedTorusHasTheSameVolume) {
  const Eigen::Matrix3d turn =
      Eigen::AngleAxisd(.8, Vector3d(1, 2, 3).normalized()).toRotationMatrix();
  const auto turned = [&](const Vector3d& p) {
    return Torus(turn * (p - Vector3d(.03, -.02, .01)));
  };
  PLEAT_ASSERT_OK_AND_ASSIGN(const TriangleSoup soup,
                             ExtractIsosurface(turned, kLow, kHigh, .07, {}));
  EXPECT_TRUE(IsClosedManifold(soup));
  EXPECT_EQ(EulerCharacteristic(soup), 0);
  const double expected = 2 * std::numbers::pi * std::numbers::pi * .35 * .35;  // Pappus
  EXPECT_NEAR(Volume(soup), expected, .03 * expected);
}

}  // namespace
}  // namespace pleat
