#include "pleat/geometry/control_topology.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <map>
#include <numeric>

#include "pleat/geometry/control_mesh.h"
#include "support/status_matchers.h"

namespace pleat {
namespace {

using ::testing::HasSubstr;

// A torus of m x n vertices: closed, so its control mesh should be closed as well.
struct Torus {
  Topology topology;
  Eigen::Matrix3Xd positions;

  Torus(int m, int n) {
    positions.resize(3, m * n);
    Eigen::Matrix3Xi triangles(3, 2 * m * n);
    int f = 0;
    for (int i = 0; i < m; ++i) {
      for (int j = 0; j < n; ++j) {
        const double a = 6.283185307179586 * i / m, b = 6.283185307179586 * j / n;
        positions.col(i * n + j) << (2 + .7 * std::cos(b)) * std::cos(a), .7 * std::sin(b),
            (2 + .7 * std::cos(b)) * std::sin(a);
        const int i1 = (i + 1) % m, j1 = (j + 1) % n;
        triangles.col(f++) << i * n + j, i * n + j1, i1 * n + j;
        triangles.col(f++) << i1 * n + j, i * n + j1, i1 * n + j1;
      }
    }
    topology = *Topology::FromTriangles(m * n, triangles);
  }
};

double Volume(const Eigen::Matrix3Xi& triangles, const Eigen::Matrix3Xd& positions) {
  double volume = 0;
  for (int f = 0; f < triangles.cols(); ++f) {
    volume += positions.col(triangles(0, f))
                  .dot(positions.col(triangles(1, f)).cross(positions.col(triangles(2, f)))) /
              6;
  }
  return volume;
}

TEST(ControlTopologyTest, AClosedSurfaceStaysClosedOrientedAndNear) {
  const Torus torus(80, 40);
  const std::vector<int> kept = SelectControlVertices(torus.topology, torus.positions, .05).value();
  PLEAT_ASSERT_OK_AND_ASSIGN(const Topology control,
                             ControlTopology(torus.topology, torus.positions, kept));
  ASSERT_EQ(control.num_vertices(), static_cast<int>(kept.size()));
  // A closed triangulation of a torus has two triangles per vertex, and every edge once each way.
  EXPECT_NEAR(control.num_triangles(), 2 * control.num_vertices(), .02 * control.num_vertices());
  std::map<std::pair<int, int>, int> edges;
  for (int f = 0; f < control.num_triangles(); ++f) {
    for (int c = 0; c < 3; ++c) {
      ++edges[{control.triangles()(c, f), control.triangles()((c + 1) % 3, f)}];
    }
  }
  int num_good = 0;
  for (const auto& [edge, count] : edges) {
    num_good += count == 1 && edges.count({edge.second, edge.first}) == 1;
  }
  EXPECT_GT(num_good, .97 * static_cast<double>(edges.size()));
  Eigen::Matrix3Xd positions(3, control.num_vertices());
  for (size_t i = 0; i < kept.size(); ++i) positions.col(i) = torus.positions.col(kept[i]);
  const double volume = Volume(torus.topology.triangles(), torus.positions);
  EXPECT_NEAR(Volume(control.triangles(), positions) / volume, 1, .12);
}

TEST(ControlTopologyTest, AllVerticesGiveTheMeshItself) {
  const Torus torus(7, 5);
  std::vector<int> all(35);
  std::iota(all.begin(), all.end(), 0);
  PLEAT_ASSERT_OK_AND_ASSIGN(const Topology control,
                             ControlTopology(torus.topology, torus.positions, all));
  EXPECT_TRUE(control == torus.topology);
}

TEST(ControlTopologyTest, BadVerticesAreNamed) {
  const Torus torus(7, 5);
  EXPECT_THAT(ControlTopology(torus.topology, torus.positions, {3, 35}),
              HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("vertex 35")));
  EXPECT_THAT(ControlTopology(torus.topology, torus.positions.leftCols(3), {0}),
              HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("3 vertices")));
  EXPECT_FALSE(ControlTopology(torus.topology, torus.positions, {}).ok());
}

}  // namespace
}  // namespace pleat
