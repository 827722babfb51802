#include "pleat/geometry/solid_surface.h"

#include <gtest/gtest.h>

#include "pleat/base/random.h"
#include "pleat/geometry/triangle_tree.h"
#include "pleat/geometry/winding_number.h"
#include "support/status_matchers.h"
#include "support/test_meshes.h"
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

TEST(SolidSurfaceTest, NeitherFacesNorVerticesOfAMeshHaveToBeInOrder) {
  // A torus with random faces turned: genus 1, one component, closed.
  const TestMesh torus = MakeTorus(12, 8, 2);
  TriangleMesh mesh{torus.positions.cast<double>(), torus.topology.triangles()};
  Random random(4);
  for (int f = 0; f < mesh.triangles.cols(); ++f) {
    if (random.UniformInt(2) == 0) Flip(&mesh, f);
  }
  PLEAT_ASSERT_OK_AND_ASSIGN(const SolidSurface surface, Prepare(mesh));
  EXPECT_TRUE(surface.report.closed());
  EXPECT_EQ(surface.report.num_components, 1);
  EXPECT_GT(surface.report.num_flipped_triangles, 0);
  EXPECT_TRUE(IsInside(surface, {1, 0, 0}));
  EXPECT_FALSE(IsInside(surface, {0, 0, 0}));
}

// Two boxes that share an edge: four triangles meet there, and each box is still turned outward.
TEST(SolidSurfaceTest, PatchesThatMeetInANonManifoldEdgeAreOrientedEachForItself) {
  TriangleMesh mesh = JoinMeshes(MakeBox({0, 0, 0}, {1, 1, 1}), MakeBox({1, 1, 0}, {2, 2, 1}));
  for (int f = 12; f < 24; ++f) Flip(&mesh, f);
  PLEAT_ASSERT_OK_AND_ASSIGN(const SolidSurface surface, Prepare(mesh));
  EXPECT_EQ(surface.report.num_welded_vertices, 2);
  EXPECT_EQ(surface.report.num_non_manifold_edges, 1);
  EXPECT_EQ(surface.report.num_boundary_edges, 0);
  EXPECT_FALSE(surface.report.closed());
  EXPECT_EQ(surface.report.num_flipped_triangles, 12);
  EXPECT_EQ(surface.report.num_components, 1);
  EXPECT_TRUE(IsInside(surface, {.5, .5, .5}));
  EXPECT_TRUE(IsInside(surface, {1.5, 1.5, .5}));
  EXPECT_FALSE(IsInside(surface, {1.5, .5, .5}));
}

TEST(SolidSurfaceTest, VerticesNearerThanAMillionthOfTheDiagonalAreOne) {
  for (const bool near : {true, false}) {
    const TriangleMesh left = MakeBox({0, 0, 0}, {1, 1, 1});
    TriangleMesh mesh = JoinMeshes(left, left);
    mesh.positions.rightCols(8).row(0).array() += near ? 1e-8 : 1e-3;
    PLEAT_ASSERT_OK_AND_ASSIGN(const SolidSurface surface, Prepare(mesh));
    EXPECT_EQ(surface.positions.cols(), near ? 8 : 16);
    EXPECT_EQ(surface.report.num_components, near ? 1 : 2);
  }
}

TEST(SolidSurfaceTest, OpenPatchesFaceAwayFromTheirOwnCenter) {
  TriangleMesh dome = MakeSphere({5, 5, 5}, 1, 12);
  int kept = 0;
  for (int f = 0; f < dome.triangles.cols(); ++f) {
    if (dome.positions(1, dome.triangles(0, f)) > 5) {
      dome.triangles.col(kept++) = dome.triangles.col(f);
    }
  }
  dome.triangles.conservativeResize(3, kept);
  for (int f = 0; f < kept; ++f) Flip(&dome, f);
  PLEAT_ASSERT_OK_AND_ASSIGN(const SolidSurface surface, Prepare(dome));
  EXPECT_EQ(surface.report.num_flipped_triangles, kept);
  EXPECT_GT(surface.report.num_boundary_edges, 0);
  EXPECT_TRUE(IsInside(surface, {5, 5.5, 5}));
}

TEST(SolidSurfaceTest, CountsMustAgree) {
  const TriangleMesh box = MakeBox({0, 0, 0}, {1, 1, 1});
  EXPECT_THAT(PrepareSolidSurface(MakeTopology(box), box.positions.leftCols(7)),
              HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("7 positions")));
}

// A vertex that only a triangle without area uses is in no triangle of the copy.
TEST(SolidSurfaceTest, VerticesOfDegenerateTrianglesAloneAreLeftOut) {
  TriangleMesh mesh = JoinMeshes(MakeBox({0, 0, 0}, {1, 2, 3}), MakeBox({5, 0, 0}, {6, 1, 1}));
  mesh.triangles.col(12) << 8, 9, 8;
  mesh.triangles.conservativeResize(3, 13);
  PLEAT_ASSERT_OK_AND_ASSIGN(const SolidSurface surface, Prepare(mesh));
  EXPECT_EQ(surface.report.num_degenerate_triangles, 1);
  EXPECT_EQ(surface.positions.cols(), 8);
  EXPECT_EQ(surface.vertex_from_input[8], -1);
  EXPECT_EQ(surface.vertex_from_input[9], -1);
}

}  // namespace
}  // namespace pleat
