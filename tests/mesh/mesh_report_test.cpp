#include "pleat/mesh/mesh_report.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <numeric>

#include "pleat/base/random.h"
#include "support/mesh_shapes.h"

namespace pleat {
namespace {

using testing::Contains;
using testing::HasSubstr;

MeshReport Inspect(int num_vertices, std::vector<int32_t> corners, std::vector<int32_t> sizes,
                   const Eigen::Matrix3Xd& positions) {
  return InspectMesh(*Topology::Create(num_vertices, std::move(corners), std::move(sizes)),
                     positions);
}

Eigen::Matrix3Xd Points(const std::vector<Eigen::Vector3d>& points) {
  Eigen::Matrix3Xd positions(3, static_cast<int>(points.size()));
  for (size_t v = 0; v < points.size(); ++v) positions.col(static_cast<int>(v)) = points[v];
  return positions;
}

TEST(MeshReportTest, CountsPartsLooseAndDoubledVertices) {
  // Two triangles that touch in space but not in the file, and one loose vertex.
  const MeshReport report = Inspect(
      7, {0, 1, 2, 3, 4, 5}, {3, 3},
      Points({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {9, 9, 9}}));
  EXPECT_EQ(report.num_components, 2);
  EXPECT_EQ(report.num_welded_components, 1);
  EXPECT_EQ(report.num_duplicate_vertices, 2);
  EXPECT_EQ(report.num_unreferenced_vertices, 1);
  EXPECT_EQ(report.num_boundary_edges, 6);
  EXPECT_FALSE(report.closed());
  EXPECT_THAT(DescribeFaults(report), Contains(HasSubstr("2 separate parts (1 when")));
}

TEST(MeshReportTest, FindsNonManifoldAndInconsistentEdges) {
  const Eigen::Matrix3Xd fan = Points({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, -1, 0}});
  EXPECT_EQ(Inspect(5, {0, 1, 2, 0, 1, 3, 0, 1, 4}, {3, 3, 3}, fan).num_non_manifold_edges, 1);
  EXPECT_EQ(Inspect(5, {0, 1, 2, 0, 1, 4}, {3, 3}, fan).num_inconsistent_edges, 1);
  EXPECT_EQ(Inspect(5, {0, 1, 2, 1, 0, 4}, {3, 3}, fan).num_inconsistent_edges, 0);
}

TEST(MeshReportTest, FindsDegenerateFaces) {
  const Eigen::Matrix3Xd line = Points({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {0, 1, 0}});
  const MeshReport report = Inspect(4, {0, 1, 2, 0, 1, 3, 0, 0, 3}, {3, 3, 3}, line);
  EXPECT_EQ(report.num_degenerate_faces, 2);
}

TEST(MeshReportTest, InsideOutIsSaid) {
  const MeshShape box = MakeBox({1, 1, 1});
  std::vector<int32_t> corners(box.topology.corner_vertices().rbegin(),
                               box.topology.corner_vertices().rend());
  const MeshReport report = Inspect(8, corners, std::vector<int32_t>(6, 4), box.positions);
  EXPECT_NEAR(report.signed_volume_m3, -1, 1e-12);
  EXPECT_THAT(DescribeFaults(report), Contains(HasSubstr("inwards")));
}

TEST(MeshReportTest, VolumeDoesNotDependOnThePlace) {
  MeshShape sphere = MakeUvSphere(0.3, 10, 20);
  const double volume = InspectMesh(sphere.topology, sphere.positions).signed_volume_m3;
  sphere.positions.colwise() += Eigen::Vector3d(1000, -50, 3);
  EXPECT_NEAR(InspectMesh(sphere.topology, sphere.positions).signed_volume_m3, volume, 1e-9);
}

// Triangles between vertices of which many share a place and some have no face.
TEST(MeshReportTest, TheNumberingOfVerticesAndFacesDoesNotMatter) {
  Random random(11);
  for (int round = 0; round < 20; ++round) {
    constexpr int kVertices = 30, kFaces = 25;
    Eigen::Matrix3Xd positions(3, kVertices);
    for (double& coordinate : positions.reshaped()) coordinate = random.UniformInt(3);
    std::vector<int> name(kVertices), order(kFaces);
    std::iota(name.begin(), name.end(), 0);
    std::iota(order.begin(), order.end(), 0);
    for (int i = kVertices - 1; i > 0; --i) std::swap(name[i], name[random.UniformInt(i + 1)]);
    for (int i = kFaces - 1; i > 0; --i) std::swap(order[i], order[random.UniformInt(i + 1)]);
    Eigen::Matrix3Xi faces(3, kFaces), renamed(3, kFaces);
    for (int& corner : faces.reshaped()) corner = random.UniformInt(kVertices - 3);
    Eigen::Matrix3Xd moved(3, kVertices);
    for (int v = 0; v < kVertices; ++v) moved.col(name[v]) = positions.col(v);
    for (int f = 0; f < kFaces; ++f) {
      for (int k = 0; k < 3; ++k) renamed(k, order[f]) = name[faces((k + f) % 3, f)];
    }
    const MeshReport a = InspectMesh(*Topology::FromTriangles(kVertices, faces), positions);
    const MeshReport b = InspectMesh(*Topology::FromTriangles(kVertices, renamed), moved);
    EXPECT_EQ(DescribeFaults(a), DescribeFaults(b));
    EXPECT_GE(a.num_unreferenced_vertices, 3);
    EXPECT_NEAR(a.signed_volume_m3, b.signed_volume_m3, 1e-12);
    EXPECT_LE(a.num_welded_components, a.num_components);
  }
}

}  // namespace
}  // namespace pleat
