#include "surface_neighbors.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <numeric>

#include "support/test_meshes.h"
#include "support/triangle_shapes.h"

namespace pleat {
namespace {

// Shortest paths along edges by Floyd and Warshall: slow and obvious.
Eigen::MatrixXd AllDistances(const Topology& topology, const Eigen::Matrix3Xd& positions) {
  const int n = topology.num_vertices();
  Eigen::MatrixXd d = Eigen::MatrixXd::Constant(n, n, std::numeric_limits<double>::infinity());
  d.diagonal().setZero();
  for (int f = 0; f < topology.num_faces(); ++f) {
    const auto face = topology.face(f);
    for (size_t c = 0; c < face.size(); ++c) {
      const int a = face[c], b = face[(c + 1) % face.size()];
      d(a, b) = d(b, a) = (positions.col(a) - positions.col(b)).norm();
    }
  }
  for (int k = 0; k < n; ++k) {
    for (int i = 0; i < n; ++i) {
      for (int j = 0; j < n; ++j) d(i, j) = std::min(d(i, j), d(i, k) + d(k, j));
    }
  }
  return d;
}

TEST(SurfaceNeighborsTest, AreTheNearestByShortestPaths) {
  const TestMesh torus = MakeTorus(9, 6, 3);
  const Eigen::Matrix3Xd positions = torus.positions.cast<double>();
  const Eigen::MatrixXd distances = AllDistances(torus.topology, positions);
  const std::vector<int> sources = {3, 17, 20, 41, 50, 8};
  for (const int count : {1, 3, 6}) {
    const auto neighbors = FindSurfaceNeighbors(torus.topology, positions, sources, count);
    ASSERT_EQ(neighbors.size(), 54u);
    for (int v = 0; v < 54; ++v) {
      std::vector<double> expected;
      for (const int source : sources) expected.push_back(distances(v, source));
      std::sort(expected.begin(), expected.end());
      ASSERT_EQ(neighbors[v].size(), static_cast<size_t>(count));
      for (int i = 0; i < count; ++i) {
        EXPECT_NEAR(neighbors[v][i].distance, expected[i], 1e-9) << v << " " << i;
        EXPECT_NEAR(distances(v, sources[neighbors[v][i].source]), expected[i], 1e-9);
      }
    }
  }
}

TEST(SurfaceNeighborsTest, ASourceIsItsOwnNearest) {
  const TestMesh torus = MakeTorus(9, 6, 3);
  const auto neighbors =
      FindSurfaceNeighbors(torus.topology, torus.positions.cast<double>(), {3, 17}, 2);
  EXPECT_EQ(neighbors[17][0].source, 1);
  EXPECT_EQ(neighbors[17][0].distance, 0);
}

TEST(SurfaceNeighborsTest, NothingBleedsAcrossAGapOfAir) {
  // A millimeter between the boxes, but no edge.
  const TriangleMesh boxes =
      JoinMeshes(MakeBox({0, 0, 0}, {1, 1, 1}), MakeBox({1.001, 0, 0}, {2, 1, 1}));
  const auto neighbors = FindSurfaceNeighbors(MakeTopology(boxes), boxes.positions, {0, 1, 2}, 3);
  for (int v = 0; v < 8; ++v) EXPECT_EQ(neighbors[v].size(), 3u);
  for (int v = 8; v < 16; ++v) EXPECT_TRUE(neighbors[v].empty());
}

TEST(SurfaceNeighborsTest, VerticesAtTheSamePlaceAreJoined) {
  // The same two boxes, touching: the seam's vertices are doubled.
  const TriangleMesh boxes =
      JoinMeshes(MakeBox({0, 0, 0}, {1, 1, 1}), MakeBox({1, 0, 0}, {2, 1, 1}));
  const auto neighbors = FindSurfaceNeighbors(MakeTopology(boxes), boxes.positions, {0}, 1);
  for (int v = 0; v < 16; ++v) {
    ASSERT_EQ(neighbors[v].size(), 1u) << v;
    EXPECT_GE(neighbors[v][0].distance,
              (boxes.positions.col(v) - boxes.positions.col(0)).norm() - 1e-12);
  }
  EXPECT_EQ(neighbors[8][0].distance, neighbors[1][0].distance);  // both at (1, 0, 0)
}

}  // namespace
}  // namespace pleat
