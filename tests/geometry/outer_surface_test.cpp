#include "pleat/geometry/outer_surface.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numbers>

#include "pleat/mesh/bounds.h"
#include "pleat/mesh/edge_sides.h"
#include "support/status_matchers.h"
#include "support/triangle_shapes.h"

namespace pleat {
namespace {

using ::testing::HasSubstr;

OuterSurface OuterOf(const TriangleMesh& mesh, const OuterSurfaceOptions& options = {}) {
  return ComputeOuterSurface(mesh.positions, mesh.triangles, options).value();
}

double VolumeOf(const OuterSurface& outer) {
  double volume = 0;
  for (Eigen::Index f = 0; f < outer.triangles.cols(); ++f) {
    const Eigen::Vector3d a = outer.positions.col(outer.triangles(0, f));
    const Eigen::Vector3d b = outer.positions.col(outer.triangles(1, f));
    const Eigen::Vector3d c = outer.positions.col(outer.triangles(2, f));
    volume += a.dot(b.cross(c)) / 6;
  }
  return volume;
}

// Every edge has as many faces that run along it one way as the other.
void ExpectClosedAndOriented(const OuterSurface& outer) {
  const std::vector<EdgeSide> sides = SortedEdgeSides(outer.triangles);
  for (size_t begin = 0, end = 0; begin < sides.size(); begin = end) {
    end = EndOfEdge(sides, begin);
    int sum = 0;
    for (size_t i = begin; i < end; ++i) sum += sides[i].forward ? 1 : -1;
    ASSERT_EQ(sum, 0);
  }
}

TriangleMesh Flipped(TriangleMesh mesh) {
  mesh.triangles.row(0).swap(mesh.triangles.row(1));
  return mesh;
}

constexpr double kBall = 4. / 3 * std::numbers::pi;  // volume of the unit ball

TEST(OuterSurfaceTest, OfABallIsTheBall) {
  const OuterSurface outer = OuterOf(MakeSphere({10, 20, 30}, 1));
  ExpectClosedAndOriented(outer);
  EXPECT_NEAR(VolumeOf(outer), kBall, .08 * kBall);
  EXPECT_EQ(outer.growth, 0);
  for (Eigen::Index v = 0; v < outer.positions.cols(); ++v) {
    EXPECT_NEAR((outer.positions.col(v) - Eigen::Vector3d(10, 20, 30)).norm(), 1,
                1.5 * outer.spacing);
  }
}

// Two balls a radius apart, one of them inside out, with a wall and a third ball inside.
TEST(OuterSurfaceTest, InnerWallsAndOrientationDoNotMatter) {
  const TriangleMesh first = MakeSphere({0, 0, 0}, 1), second = MakeSphere({1, 0, 0}, 1);
  const TriangleMesh inner =
      JoinMeshes(MakeSphere({.5, 0, 0}, .4), MakeBox({.4, -.5, -.5}, {.5, .5, .5}));
  const OuterSurface plain = OuterOf(JoinMeshes(first, second));
  const OuterSurface walled = OuterOf(JoinMeshes(JoinMeshes(first, Flipped(second)), inner));
  EXPECT_NEAR(VolumeOf(plain), kBall * (2 - 5. / 16), .08 * kBall);
  EXPECT_EQ(walled.positions, plain.positions);
  EXPECT_EQ(walled.triangles, plain.triangles);
}

TEST(OuterSurfaceTest, HolesAndSlitsAreClosed) {
  TriangleMesh open = MakeSphere({0, 0, 0}, 1, 40);
  int kept = 0;  // a slit around the equator
  for (int f = 0; f < open.triangles.cols(); ++f) {
    if (std::abs(open.positions(1, open.triangles(0, f))) < .03) continue;
    open.triangles.col(kept++) = open.triangles.col(f);
  }
  open.triangles.conservativeResize(3, kept);
  const OuterSurface outer = OuterOf(open);
  ExpectClosedAndOriented(outer);
  EXPECT_GT(outer.growth, 0);
  EXPECT_NEAR(VolumeOf(outer), kBall, .1 * kBall);
  EXPECT_EQ(OuterOf(MakeSphere({0, 0, 0}, 1, 40)).growth, 0);
}

class StrayPartTest : public testing::TestWithParam<double> {};

// A crumb at any distance neither stays nor makes the voxels larger.
TEST_P(StrayPartTest, IsLeftOut) {
  const TriangleMesh ball = MakeSphere({0, 0, 0}, 1);
  const double x = GetParam();
  const TriangleMesh both = JoinMeshes(MakeBox({x, 0, 0}, {x + .1, .1, .1}), ball);
  const OuterSurface outer = OuterOf(both);
  EXPECT_LT(outer.positions.row(0).maxCoeff(), 1.1);
  EXPECT_LT(outer.spacing, 3. / 144);
  EXPECT_NEAR(VolumeOf(outer), kBall, .08 * kBall);
}

INSTANTIATE_TEST_SUITE_P(AtAnyDistance, StrayPartTest, testing::Values(1.4, 3., 40., 1e5));

// Parts that nearly touch are one body, as those of a robot.
TEST(OuterSurfaceTest, PiecesWithSmallGapsStayTogether) {
  TriangleMesh chain = MakeSphere({0, 0, 0}, .5);
  for (int k = 1; k < 4; ++k) chain = JoinMeshes(chain, MakeSphere({1.05 * k, 0, 0}, .5));
  const OuterSurface outer = OuterOf(chain);
  EXPECT_GT(outer.growth, 0);
  EXPECT_GT(ComputeBounds(outer.positions).sizes().x(), 4);
}

TEST(OuterSurfaceTest, RefusesWhatEnclosesNothingAndBadOptions) {
  TriangleMesh sheet{Eigen::Matrix3Xd(3, 4), Eigen::Matrix3Xi(3, 2)};
  sheet.positions << 0, 1, 1, 0, 0, 0, 1, 1, 0, 0, 0, 0;
  sheet.triangles << 0, 0, 1, 2, 2, 3;
  EXPECT_THAT(ComputeOuterSurface(sheet.positions, sheet.triangles),
              HasStatus(absl::StatusCode::kFailedPrecondition, HasSubstr("encloses nothing")));
  EXPECT_TRUE(absl::IsInvalidArgument(
      ComputeOuterSurface(sheet.positions, Eigen::Matrix3Xi(3, 0)).status()));
  OuterSurfaceOptions coarse;
  coarse.resolution = 2;
  EXPECT_TRUE(absl::IsInvalidArgument(
      ComputeOuterSurface(sheet.positions, sheet.triangles, coarse).status()));
}

}  // namespace
}  // namespace pleat
