#include "pleat/rigging/sphere_graph.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "pleat/base/random.h"
#include "pleat/geometry/triangle_tree.h"
#include "pleat/geometry/winding_number.h"
#include "support/status_matchers.h"
#include "support/triangle_shapes.h"

namespace pleat {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

TEST(SphereGraphTest, FindsShortestPaths) {
  // A square with a short cut over node 4 and node 5 on its own.
  std::vector<Sphere> spheres = {{{0, 0, 0}, .1}, {{3, 0, 0}, .1},     {{3, 3, 0}, .1},
                                 {{0, 3, 0}, .1}, {{1.5, 1.5, 0}, .1}, {{9, 9, 9}, .1}};
  const SphereGraph graph(spheres, {{0, 1}, {1, 2}, {2, 3}, {3, 0}, {0, 4}, {4, 2}});
  EXPECT_DOUBLE_EQ(graph.PathLength(0, 2), 2 * std::sqrt(4.5));
  EXPECT_THAT(graph.Path(0, 2), ElementsAre(0, 4, 2));
  EXPECT_THAT(graph.Path(2, 0), ElementsAre(2, 4, 0));
  EXPECT_DOUBLE_EQ(graph.PathLength(1, 3), 6);
  EXPECT_THAT(graph.Path(3, 3), ElementsAre(3));
  EXPECT_TRUE(std::isinf(graph.PathLength(0, 5)));
  EXPECT_THAT(graph.Path(0, 5), IsEmpty());
}

// Against the algorithm of Floyd and Warshall, which is three loops.
TEST(SphereGraphTest, ShortestPathsOfRandomGraphsAreShortest) {
  for (uint64_t seed = 1; seed <= 5; ++seed) {
    Random random(seed);
    constexpr int kNumSpheres = 25;
    std::vector<Sphere> spheres;
    for (int i = 0; i < kNumSpheres; ++i) {
      spheres.push_back({{random.Uniform(), random.Uniform(), random.Uniform()}, .1});
    }
    Eigen::MatrixXd lengths = Eigen::MatrixXd::Constant(kNumSpheres, kNumSpheres, INFINITY);
    lengths.diagonal().setZero();
    std::vector<std::pair<int, int>> edges;
    for (int k = 0; k < 30; ++k) {
      const int a = random.UniformInt(kNumSpheres), b = random.UniformInt(kNumSpheres);
      if (a == b || std::isfinite(lengths(a, b))) continue;
      edges.push_back({a, b});
      lengths(a, b) = lengths(b, a) = (spheres[a].center - spheres[b].center).norm();
    }
    const SphereGraph graph(spheres, edges);
    for (int k = 0; k < kNumSpheres; ++k) {
      for (int i = 0; i < kNumSpheres; ++i) {
        for (int j = 0; j < kNumSpheres; ++j) {
          lengths(i, j) = std::min(lengths(i, j), lengths(i, k) + lengths(k, j));
        }
      }
    }
    for (int i = 0; i < kNumSpheres; ++i) {
      for (int j = 0; j < kNumSpheres; ++j) {
        const std::vector<int> path = graph.Path(i, j);
        if (!std::isfinite(lengths(i, j))) {
          EXPECT_TRUE(path.empty());
          EXPECT_EQ(graph.PathLength(i, j), lengths(i, j));
          EXPECT_EQ(graph.Predecessor(i, j), -1);
          continue;
        }
        EXPECT_NEAR(graph.PathLength(i, j), lengths(i, j), 1e-12);
        double walked = 0;
        for (size_t n = 1; n < path.size(); ++n) {
          EXPECT_THAT(graph.neighbors(path[n - 1]), ::testing::Contains(path[n]));
          walked += (spheres[path[n]].center - spheres[path[n - 1]].center).norm();
        }
        EXPECT_NEAR(walked, lengths(i, j), 1e-12);
        EXPECT_EQ(path.front(), i);
        EXPECT_EQ(path.back(), j);
      }
    }
  }
}

// Two chains, the second one with more spheres but less volume.
TEST(SphereGraphTest, TheLargestGroupKeepsOrderAndPaths) {
  const std::vector<Sphere> spheres = {{{9, 0, 0}, .1}, {{0, 0, 0}, .3}, {{9, 1, 0}, .1},
                                       {{2, 0, 0}, .2}, {{9, 2, 0}, .1}, {{5, 0, 0}, .2}};
  const SphereGraph whole(spheres, {{0, 2}, {2, 4}, {1, 3}, {3, 5}});
  const SphereGraph group = whole.LargestGroup();
  ASSERT_EQ(group.size(), 3);
  for (const auto& [own, before] : {std::pair(0, 1), {1, 3}, {2, 5}}) {
    EXPECT_EQ(group.sphere(own).center, spheres[before].center);
  }
  EXPECT_THAT(group.neighbors(1), ElementsAre(0, 2));
  EXPECT_THAT(group.Path(0, 2), ElementsAre(0, 1, 2));
  EXPECT_EQ(group.PathLength(2, 0), 5);
  EXPECT_EQ(group.Predecessor(0, 0), -1);
  EXPECT_EQ(group.LargestGroup().size(), 3);
}

TEST(SphereGraphTest, TurningKeepsTheLengths) {
  const SphereGraph graph({{{1, 0, 0}, .1}, {{3, 0, 0}, .2}}, {{0, 1}});
  const SphereGraph turned =
      graph.Turned(Eigen::AngleAxisd(EIGEN_PI / 2, Eigen::Vector3d::UnitZ()).toRotationMatrix());
  EXPECT_LT((turned.sphere(1).center - Eigen::Vector3d(0, 3, 0)).norm(), 1e-12);
  EXPECT_EQ(turned.sphere(1).radius, .2);
  EXPECT_EQ(turned.PathLength(0, 1), 2);
}

TEST(SphereGraphTest, JoinsOverlapsAndClearSightOnly) {
  const TriangleMesh mesh = MakeBox({0, 0, 0}, {4, 1, 1});
  const TriangleTree tree(mesh.positions, mesh.triangles);
  const WindingNumber winding_number(tree);
  DistanceFieldOptions options;
  options.resolution = 64;
  PLEAT_ASSERT_OK_AND_ASSIGN(const DistanceField field,
                             DistanceField::Compute(tree, winding_number, options));
  const std::vector<Sphere> spheres = {{{.5, .5, .5}, .5},
                                       {{1.2, .5, .5}, .5},     // overlaps the first
                                       {{2.5, .5, .5}, .3},     // sees the second
                                       {{3.9, .95, .95}, .04},  // in a corner, sees the third
                                       {{2, 3, .5}, .5}};       // outside
  const SphereGraph graph(spheres, field);
  EXPECT_THAT(graph.neighbors(0), ElementsAre(1));  // the second hides the third: not Gabriel
  EXPECT_THAT(graph.neighbors(1), ElementsAre(0, 2));
  EXPECT_THAT(graph.neighbors(2), ElementsAre(1, 3));
  EXPECT_THAT(graph.neighbors(4), IsEmpty());
}

}  // namespace
}  // namespace pleat
