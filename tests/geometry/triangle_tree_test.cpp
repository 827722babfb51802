#include "pleat/geometry/triangle_tree.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "pleat/base/random.h"
#include "support/triangle_shapes.h"

namespace pleat {
namespace {

Eigen::Vector3d RandomPoint(Random* random, double reach) {
  return {random->Uniform(-reach, reach), random->Uniform(-reach, reach),
          random->Uniform(-reach, reach)};
}

// Nearest of many points sampled on the triangle.
double SampledDistance(const Eigen::Vector3d& point,
                       const std::array<Eigen::Vector3d, 3>& corners) {
  constexpr int kSteps = 60;
  double nearest = 1e9;
  for (int i = 0; i <= kSteps; ++i) {
    for (int j = 0; i + j <= kSteps; ++j) {
      const double a = static_cast<double>(i) / kSteps, b = static_cast<double>(j) / kSteps;
      const Eigen::Vector3d sample = a * corners[0] + b * corners[1] + (1 - a - b) * corners[2];
      nearest = std::min(nearest, (sample - point).norm());
    }
  }
  return nearest;
}

TEST(TriangleTreeTest, ClosestPointOnTriangleBeatsEverySampleOfIt) {
  Random random(3);
  for (int i = 0; i < 200; ++i) {
    const std::array<Eigen::Vector3d, 3> corners = {
        RandomPoint(&random, 1), RandomPoint(&random, 1), RandomPoint(&random, 1)};
    const Eigen::Vector3d point = RandomPoint(&random, 2);
    const double distance = (ClosestPointOnTriangle(point, corners) - point).norm();
    const double sampled = SampledDistance(point, corners);
    EXPECT_LE(distance, sampled + 1e-12);
    EXPECT_GE(distance, sampled - 0.06);
  }
}

TEST(TriangleTreeTest, DegenerateTrianglesGiveFinitePoints) {
  const Eigen::Vector3d a(1, 2, 3), b(2, 2, 3);
  for (const auto& corners : {std::array{a, a, a}, std::array{a, b, b}, std::array{a, a, b}}) {
    EXPECT_TRUE(ClosestPointOnTriangle({0, 0, 0}, corners).allFinite());
  }
}

TEST(TriangleTreeTest, AgreesWithBruteForce) {
  const TriangleMesh mesh = MakeSphere({.3, -.2, .1}, 1, 16);
  const TriangleTree tree(mesh.positions, mesh.triangles);
  Random random(5);
  for (int i = 0; i < 300; ++i) {
    const Eigen::Vector3d point = RandomPoint(&random, 2);
    double nearest = 1e9;
    for (int f = 0; f < mesh.triangles.cols(); ++f) {
      const std::array<Eigen::Vector3d, 3> corners = {mesh.positions.col(mesh.triangles(0, f)),
                                                      mesh.positions.col(mesh.triangles(1, f)),
                                                      mesh.positions.col(mesh.triangles(2, f))};
      nearest = std::min(nearest, (ClosestPointOnTriangle(point, corners) - point).squaredNorm());
    }
    const SurfacePoint found = tree.ClosestPoint(point);
    EXPECT_NEAR(found.squared_distance, nearest, 1e-12);
    EXPECT_NEAR((found.position - point).squaredNorm(), nearest, 1e-12);
    EXPECT_GE(found.triangle, 0);
    EXPECT_EQ(tree.ClosestPoint(point, nearest * .999).triangle, -1);
    EXPECT_GE(tree.ClosestPoint(point, nearest * 1.001 + 1e-9).triangle, 0);
  }
}

TEST(TriangleTreeTest, EmptyTreeFindsNothing) {
  const TriangleTree tree(Eigen::Matrix3Xd(3, 0), Eigen::Matrix3Xi(3, 0));
  EXPECT_EQ(tree.ClosestPoint({0, 0, 0}).triangle, -1);
}

double DistanceToSegment(const Eigen::Vector3d& point, const Eigen::Vector3d& start,
                         const Eigen::Vector3d& end) {
  const Eigen::ParametrizedLine<double, 3> line(start, (end - start).normalized());
  const double along = std::clamp((point - start).dot(line.direction()), 0., (end - start).norm());
  return (line.pointAt(along) - point).norm();
}

// Corners on one line, some of them at one place, and slivers that rounding makes of them.
TEST(TriangleTreeTest, TrianglesWithoutAreaAreTheirEdges) {
  Random random(6);
  for (const double height : {0., 1e-15, 1e-12, 1e-9, 1e-7}) {
    for (int i = 0; i < 2000; ++i) {
      const Eigen::Vector3d start = RandomPoint(&random, 1), along = RandomPoint(&random, 1);
      std::array<double, 3> places = {random.Uniform(-1, 1), random.Uniform(-1, 1),
                                      random.Uniform(-1, 1)};
      const int same = random.UniformInt(6);  // of half of them two corners are one
      if (same < 3) places[same] = places[(same + 1) % 3];
      std::array<Eigen::Vector3d, 3> corners;
      for (int k = 0; k < 3; ++k) corners[k] = start + places[k] * along;
      corners[2] += height * RandomPoint(&random, 1);
      const Eigen::Vector3d point = RandomPoint(&random, 2);
      const double expected = std::min({DistanceToSegment(point, corners[0], corners[1]),
                                        DistanceToSegment(point, corners[1], corners[2]),
                                        DistanceToSegment(point, corners[2], corners[0])});
      EXPECT_NEAR((ClosestPointOnTriangle(point, corners) - point).norm(), expected,
                  1e-9 + 2 * height)
          << i << " " << height;
    }
  }
}

// Each of the seven regions around a triangle, by hand.
TEST(TriangleTreeTest, EveryRegionOfATriangleHasItsNearestPoint) {
  const std::array<Eigen::Vector3d, 3> corners = {
      Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(4, 0, 0), Eigen::Vector3d(0, 4, 0)};
  for (const double z : {0., -3.}) {
    const auto expect = [&](double x, double y, double near_x, double near_y) {
      EXPECT_LT(
          (ClosestPointOnTriangle({x, y, z}, corners) - Eigen::Vector3d(near_x, near_y, 0)).norm(),
          1e-12)
          << x << " " << y << " " << z;
    };
    expect(-1, -2, 0, 0);
    expect(6, -1, 4, 0);
    expect(-1, 7, 0, 4);
    expect(1, -2, 1, 0);
    expect(-5, 3, 0, 3);
    expect(4, 4, 2, 2);
    expect(1, 2, 1, 2);
  }
}

TEST(TriangleTreeTest, NodesHoldTheirTrianglesAndChildrenShareThem) {
  const TriangleMesh mesh = MakeSphere({0, 0, 0}, 1, 12);
  const TriangleTree tree(mesh.positions, mesh.triangles);
  const auto& nodes = tree.nodes();
  ASSERT_EQ(nodes[0].count, mesh.triangles.cols());
  for (size_t n = 0; n < nodes.size(); ++n) {
    for (int k = nodes[n].first; k < nodes[n].first + nodes[n].count; ++k) {
      for (const Eigen::Vector3d& corner : tree.corners(k)) {
        EXPECT_TRUE((corner.array() >= nodes[n].low.array()).all());
        EXPECT_TRUE((corner.array() <= nodes[n].high.array()).all());
      }
    }
    if (nodes[n].is_leaf()) continue;
    const TriangleTree::Node &left = nodes[n + 1], &right = nodes[nodes[n].right];
    EXPECT_EQ(left.first, nodes[n].first);
    EXPECT_EQ(right.first, left.first + left.count);
    EXPECT_EQ(left.count + right.count, nodes[n].count);
  }
}

TEST(TriangleTreeTest, NeitherOrderNorMotionOfTheMeshChangesWhatIsNearest) {
  const TriangleMesh mesh = MakeSphere({.3, -.2, .1}, 1, 10);
  const TriangleTree tree(mesh.positions, mesh.triangles);
  const TriangleTree reversed(mesh.positions, mesh.triangles.rowwise().reverse());
  const Eigen::Matrix3d turn =
      Eigen::AngleAxisd(1, Eigen::Vector3d(1, 2, -1).normalized()).toRotationMatrix();
  const Eigen::Vector3d shift(5, -1, 2);
  const TriangleTree moved(Eigen::Matrix3Xd((turn * mesh.positions).colwise() + shift),
                           mesh.triangles);
  Random random(8);
  for (int i = 0; i < 200; ++i) {
    const Eigen::Vector3d point = RandomPoint(&random, 2);
    const SurfacePoint found = tree.ClosestPoint(point);
    EXPECT_NEAR(reversed.ClosestPoint(point).squared_distance, found.squared_distance, 1e-12);
    const SurfacePoint turned = moved.ClosestPoint(turn * point + shift);
    EXPECT_NEAR(turned.squared_distance, found.squared_distance, 1e-12);
    // The triangle that is named holds the point.
    std::array<Eigen::Vector3d, 3> corners;
    for (int k = 0; k < 3; ++k) {
      corners[k] = mesh.positions.col(mesh.triangles(k, found.triangle));
    }
    EXPECT_LT((ClosestPointOnTriangle(found.position, corners) - found.position).norm(), 1e-12);
  }
}

TEST(TriangleTreeTest, TheRadiusOfASearchIsExclusive) {
  const TriangleMesh box = MakeBox({0, 0, 0}, {1, 1, 1});
  const TriangleTree tree(box.positions, box.triangles);
  const SurfacePoint none = tree.ClosestPoint({.5, .25, 3}, 4);  // exactly 2 away
  EXPECT_EQ(none.triangle, -1);
  EXPECT_EQ(none.squared_distance, 4);
  EXPECT_GE(tree.ClosestPoint({.5, .25, 3}, std::nextafter(4., 5)).triangle, 0);
}

}  // namespace
}  // namespace pleat
