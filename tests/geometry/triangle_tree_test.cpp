#include "pleat/geometry/triangle_tree.h"

#include <gtest/gtest.h>

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

}  // namespace
}  // namespace pleat
