#include "pleat/geometry/control_mesh.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "support/mesh_shapes.h"
#include "support/status_matchers.h"

namespace pleat {
namespace {

using ::testing::HasSubstr;

// A rolled sheet of rows x columns vertices (open borders on all sides unless closed around).
MeshShape Sheet(int rows, int columns, bool closed) {
  MeshShape mesh;
  mesh.positions.resize(3, rows * columns);
  std::vector<int32_t> corners, sizes;
  for (int r = 0; r < rows; ++r) {
    for (int c = 0; c < columns; ++c) {
      const double angle = 6.2831853 * c / columns * (closed ? 1 : 0.7);
      mesh.positions.col(r * columns + c) << std::cos(angle), 2.0 * r / rows,
          std::sin(angle) * (1 + 0.2 * std::sin(0.3 * r));
      const int next = closed ? (c + 1) % columns : c + 1;
      if (r + 1 == rows || next == columns) continue;
      const int a = r * columns + c, b = r * columns + next;
      corners.insert(corners.end(), {a, b, b + columns, a + columns});
      sizes.push_back(4);
    }
  }
  mesh.topology = *Topology::Create(rows * columns, corners, sizes);
  return mesh;
}

// Copies of `mesh` side by side, and `num_loose` vertices without faces.
MeshShape Copies(const MeshShape& mesh, int count, int num_loose = 0) {
  MeshShape result;
  const int size = mesh.topology.num_vertices();
  result.positions = Eigen::Matrix3Xd::Zero(3, size * count + num_loose);
  std::vector<int32_t> corners, sizes;
  for (int i = 0; i < count; ++i) {
    result.positions.middleCols(i * size, size) =
        mesh.positions.colwise() + Eigen::Vector3d(3 * i, 0, 0);
    for (int f = 0; f < mesh.topology.num_faces(); ++f) {
      for (const int v : mesh.topology.face(f)) corners.push_back(v + i * size);
      sizes.push_back(static_cast<int32_t>(mesh.topology.face(f).size()));
    }
  }
  result.topology = *Topology::Create(size * count + num_loose, corners, sizes);
  return result;
}

void ExpectSubset(const std::vector<int>& kept, int num_vertices) {
  EXPECT_TRUE(std::is_sorted(kept.begin(), kept.end()));
  EXPECT_EQ(std::set<int>(kept.begin(), kept.end()).size(), kept.size());
  EXPECT_GE(kept.front(), 0);
  EXPECT_LT(kept.back(), num_vertices);
}

TEST(ControlMeshTest, KeepsTheAskedShareAtAllLevels) {
  for (const bool closed : {true, false}) {
    const MeshShape mesh = Sheet(60, 50, closed);
    for (const double fraction : {1.0, .75, .5, .25, .1, .05, .001}) {
      PLEAT_ASSERT_OK_AND_ASSIGN(const std::vector<int> kept,
                                 SelectControlVertices(mesh.topology, mesh.positions, fraction));
      EXPECT_EQ(kept.size(), static_cast<size_t>(std::lround(3000 * fraction)));
      ExpectSubset(kept, 3000);
    }
  }
}

TEST(ControlMeshTest, CoversTheSurface) {
  const MeshShape mesh = Sheet(60, 50, true);
  PLEAT_ASSERT_OK_AND_ASSIGN(const std::vector<int> kept,
                             SelectControlVertices(mesh.topology, mesh.positions, .05));
  double farthest = 0;
  for (int v = 0; v < 3000; ++v) {
    double nearest = 1e9;
    for (const int c : kept) {
      nearest = std::min(nearest, (mesh.positions.col(v) - mesh.positions.col(c)).norm());
    }
    farthest = std::max(farthest, nearest);
  }
  EXPECT_LT(farthest, 0.6);  // area 12.6 / 150 vertices: mean spacing 0.29
}

TEST(ControlMeshTest, Deterministic) {
  const MeshShape mesh = Sheet(40, 40, true);
  EXPECT_EQ(*SelectControlVertices(mesh.topology, mesh.positions, .1),
            *SelectControlVertices(mesh.topology, mesh.positions, .1));
}

TEST(ControlMeshTest, EveryComponentKeepsAVertex) {
  const MeshShape mesh = Copies(Sheet(4, 5, true), 30);
  PLEAT_ASSERT_OK_AND_ASSIGN(const std::vector<int> kept,
                             SelectControlVertices(mesh.topology, mesh.positions, .01));
  EXPECT_EQ(kept.size(), 30u);
  std::set<int> components;
  for (const int v : kept) components.insert(v / 20);
  EXPECT_EQ(components.size(), 30u);
}

TEST(ControlMeshTest, LooseVerticesAndPointCloudsAreServed) {
  const MeshShape mesh = Copies(Sheet(20, 20, true), 1, 5);
  PLEAT_ASSERT_OK_AND_ASSIGN(const std::vector<int> kept,
                             SelectControlVertices(mesh.topology, mesh.positions, .1));
  EXPECT_EQ(kept.size(), 41u);  // round(40.5)
  ExpectSubset(kept, 405);

  const Topology cloud = *Topology::Create(100, {}, {});
  const Eigen::Matrix3Xd points = mesh.positions.leftCols(100);
  PLEAT_ASSERT_OK_AND_ASSIGN(const std::vector<int> some, SelectControlVertices(cloud, points, .2));
  EXPECT_EQ(some.size(), 20u);
}

TEST(ControlMeshTest, TrianglesThatShareNoVertexAreWeldedByPlace) {
  const MeshShape sheet = Sheet(20, 20, true);
  const Eigen::Matrix3Xi triangles = sheet.topology.triangles();
  MeshShape soup;
  soup.positions.resize(3, triangles.size());
  Eigen::Matrix3Xi separate(3, triangles.cols());
  for (Eigen::Index i = 0; i < triangles.size(); ++i) {
    soup.positions.col(i) = sheet.positions.col(triangles.data()[i]);
    separate.data()[i] = static_cast<int>(i);
  }
  const int count = static_cast<int>(triangles.size());
  soup.topology = *Topology::FromTriangles(count, separate);
  PLEAT_ASSERT_OK_AND_ASSIGN(const std::vector<int> kept,
                             SelectControlVertices(soup.topology, soup.positions, .05));
  EXPECT_EQ(kept.size(), static_cast<size_t>(std::lround(.05 * count)));
}

TEST(ControlMeshTest, AllVerticesAtOnePlace) {
  MeshShape mesh = Sheet(10, 10, true);
  mesh.positions.setOnes();
  PLEAT_ASSERT_OK_AND_ASSIGN(const std::vector<int> kept,
                             SelectControlVertices(mesh.topology, mesh.positions, .1));
  EXPECT_EQ(kept.size(), 10u);
  ExpectSubset(kept, 100);
}

TEST(ControlMeshTest, WrongInputIsRefusedWithWords) {
  const MeshShape mesh = Sheet(5, 5, true);
  for (const double fraction : {0.0, -0.5, 1.01, std::nan("")}) {
    EXPECT_THAT(SelectControlVertices(mesh.topology, mesh.positions, fraction),
                HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("fraction")));
  }
  EXPECT_THAT(SelectControlVertices(mesh.topology, mesh.positions.leftCols(24), .5),
              HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("24")));
}

}  // namespace
}  // namespace pleat
