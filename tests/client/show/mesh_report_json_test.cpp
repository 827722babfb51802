#include "cli/show/mesh_report_json.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "support/triangle_shapes.h"

namespace pleat {
namespace {

nlohmann::ordered_json Report(const TriangleMesh& mesh) {
  return MeshReportJson(InspectMesh(MakeTopology(mesh), mesh.positions));
}

TEST(MeshReportJsonTest, ACleanBoxHasNoFaultsAndItsVolume) {
  const nlohmann::ordered_json json = Report(MakeBox({0, 0, 0}, {1, 2, 3}));
  EXPECT_EQ(json["closed"], true);
  EXPECT_EQ(json["num_components"], 1);
  EXPECT_NEAR(json["signed_volume_m3"].get<double>(), 6, 1e-12);
  EXPECT_TRUE(json["faults"].empty());
}

TEST(MeshReportJsonTest, AMissingTriangleIsThreeBoundaryEdgesAndASentence) {
  TriangleMesh box = MakeBox({0, 0, 0}, {1, 1, 1});
  box.triangles = box.triangles.leftCols(11).eval();
  const nlohmann::ordered_json json = Report(box);
  EXPECT_EQ(json["closed"], false);
  EXPECT_EQ(json["num_boundary_edges"], 3);
  EXPECT_EQ(json["faults"].size(), 1u);
}

TEST(MeshReportJsonTest, EveryCountHasItsOwnMember) {
  MeshReport report;
  report.num_components = 1;
  report.num_welded_components = 2;
  report.num_boundary_edges = 3;
  report.num_non_manifold_edges = 4;
  report.num_inconsistent_edges = 5;
  report.num_unreferenced_vertices = 6;
  report.num_duplicate_vertices = 7;
  report.num_degenerate_faces = 8;
  report.signed_volume_m3 = -9;
  const nlohmann::ordered_json json = MeshReportJson(report);
  int expected = 1;
  for (const char* member :
       {"num_components", "num_welded_components", "num_boundary_edges", "num_non_manifold_edges",
        "num_inconsistent_edges", "num_unreferenced_vertices", "num_duplicate_vertices",
        "num_degenerate_faces"}) {
    EXPECT_EQ(json[member], expected++) << member;
  }
  EXPECT_EQ(json["signed_volume_m3"], -9);
  EXPECT_EQ(json["faults"], DescribeFaults(report));
}

TEST(MeshReportJsonTest, TwoBoxesAreTwoComponents) {
  const nlohmann::ordered_json json =
      Report(JoinMeshes(MakeBox({0, 0, 0}, {1, 1, 1}), MakeBox({2, 0, 0}, {3, 1, 1})));
  EXPECT_EQ(json["num_components"], 2);
  EXPECT_EQ(json["closed"], true);
}

}  // namespace
}  // namespace pleat
