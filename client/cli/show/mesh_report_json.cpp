#include "cli/show/mesh_report_json.h"

#include <nlohmann/json.hpp>

namespace pleat {

nlohmann::ordered_json MeshReportJson(const MeshReport& report) {
  nlohmann::ordered_json json;
  json["closed"] = report.closed();
  json["num_components"] = report.num_components;
  json["num_welded_components"] = report.num_welded_components;
  json["num_boundary_edges"] = report.num_boundary_edges;
  json["num_non_manifold_edges"] = report.num_non_manifold_edges;
  json["num_inconsistent_edges"] = report.num_inconsistent_edges;
  json["num_unreferenced_vertices"] = report.num_unreferenced_vertices;
  json["num_duplicate_vertices"] = report.num_duplicate_vertices;
  json["num_degenerate_faces"] = report.num_degenerate_faces;
  json["signed_volume_m3"] = report.signed_volume_m3;
  json["faults"] = DescribeFaults(report);
  return json;
}

}  // namespace pleat
