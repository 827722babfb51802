#include "pleat/geometry/solid_surface.h"

#include <gtest/gtest.h>

#include "pleat/geometry/triangle_tree.h"
#include "pleat/geometry/winding_number.h"
#include "support/status_matchers.h"
#include "support/triangle_shapes.h"

namespace pleat {
namespace {

using ::testing::HasSubstr;

absl::StatusOr<SolidSurface> Prepare(const TriangleMesh& mesh) {
  return PrepareSolidSurface(MakeTopology(mesh), mesh.positions);
}

void Flip(TriangleMesh* mesh, int f) { std::swap(mesh->triangles(0, f), mesh->triangles(1, f)); }

bool IsInside(const SolidSurface& surface, const Eigen::Vector3d& point) {
  const TriangleTree tree(surface.positions, surface.triangles);
  return WindingNumber(tree).IsInside(point);
}

TEST(SolidSurfaceTest, CleanMeshIsLeftAlone) {
  const TriangleMesh mesh = MakeBox({0, 0, 0}, {1, 2, 3});
  PLEAT_ASSERT_OK_AND_ASSIGN(const SolidSurface surface, Prepare(mesh));
  EXPECT_EQ(surface.positions, mesh.positions);
  EXPECT_EQ(surface.triangles, mesh.triangles);
  EXPECT_EQ(surface.report.num_components, 1);
  EXPECT_EQ(surface.report.num_boundary_edges, 0);
  EXPECT_EQ(surface.report.num_flipped_triangles, 0);
}

TEST(SolidSurfaceTest, WeldsATriangleSoupAndKeepsTheMapToTheInput) {
  const TriangleMesh box = MakeBox({0, 0, 0}, {1, 2, 3});
  TriangleMesh soup{Eigen::Matrix3Xd(3, 37), Eigen::Matrix3Xi(3, 12)};
  soup.positions.col(36) << 9, 9, 9;  // no triangle uses it
  for (int c = 0; c < 36; ++c) {
    soup.positions.col(c) = box.positions.col(box.triangles(c % 3, c / 3));
    soup.triangles(c % 3, c / 3) = c;
  }
  PLEAT_ASSERT_OK_AND_ASSIGN(const SolidSurface surface, Prepare(soup));
  EXPECT_EQ(surface.positions.cols(), 8);
  EXPECT_EQ(surface.report.num_welded_vertices, 28);
  EXPECT_EQ(surface.report.num_unreferenced_vertices, 1);
  EXPECT_EQ(surface.report.num_components, 1);
  EXPECT_EQ(surface.vertex_from_input[36], -1);
  for (int v = 0; v < 36; ++v) {
    EXPECT_EQ(Eigen::Vector3d(surface.positions.col(surface.vertex_from_input[v])),
              Eigen::Vector3d(soup.positions.col(v)));
  }
}

TEST(SolidSurfaceTest, TurnsEveryComponentOutward) {
  TriangleMesh mesh = JoinMeshes(MakeBox({0, 0, 0}, {1, 1, 1}), MakeBox({5, 0, 0}, {6, 1, 1}));
  Flip(&mesh, 3);
  Flip(&mesh, 7);
  for (int f = 12; f < 24; ++f) Flip(&mesh, f);
  PLEAT_ASSERT_OK_AND_ASSIGN(const SolidSurface surface, Prepare(mesh));
  EXPECT_EQ(surface.report.num_components, 2);
  EXPECT_EQ(surface.report.num_flipped_triangles, 14);
  EXPECT_EQ(surface.triangle_components[0], 0);
  EXPECT_EQ(surface.triangle_components[12], 1);
  EXPECT_TRUE(IsInside(surface, {.5, .5, .5}));
  EXPECT_TRUE(IsInside(surface, {5.5, .5, .5}));
  EXPECT_FALSE(IsInside(surface, {3, .5, .5}));
}

TEST(SolidSurfaceTest, CountsHolesDegenerateTrianglesAndNonManifoldEdges) {
  TriangleMesh mesh = MakeBox({0, 0, 0}, {1, 1, 1});
  mesh.triangles.col(0) << 5, 5, 6;  // a hole of three edges and a triangle without area
  PLEAT_ASSERT_OK_AND_ASSIGN(const SolidSurface open, Prepare(mesh));
  EXPECT_EQ(open.report.num_degenerate_triangles, 1);
  EXPECT_EQ(open.report.num_boundary_edges, 3);
  TriangleMesh fin = MakeBox({0, 0, 0}, {1, 1, 1});
  fin.positions.conservativeResize(3, 9);
  fin.positions.col(8) << -1, 2, -1;
  fin.triangles.conservativeResize(3, 13);
  fin.triangles.col(12) << 0, 1, 8;
  PLEAT_ASSERT_OK_AND_ASSIGN(const SolidSurface with_fin, Prepare(fin));
  EXPECT_EQ(with_fin.report.num_non_manifold_edges, 1);
  EXPECT_EQ(with_fin.report.num_components, 1);
}

TEST(SolidSurfaceTest, RefusesAMeshWithoutArea) {
  const TriangleMesh flat{Eigen::Matrix3Xd::Zero(3, 3), Eigen::Vector3i(0, 1, 2)};
  EXPECT_THAT(Prepare(flat),
              HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("encloses nothing")));
}

}  // namespace
}  // namespace pleat
