// The pre-flight of a user's mesh: what a volume method needs, made from whatever the file holds
// (docs/method/rig.md#solid-surface).
#pragma once

#include <Eigen/Core>
#include <vector>

#include "absl/status/statusor.h"
#include "pleat/mesh/topology.h"

namespace pleat {

// Counts what was unclean about a mesh, on its welded triangles; MeshReport (mesh_report.h) counts
// on the mesh as it is.
struct SurfaceReport {
  int num_welded_vertices = 0;  // vertices at the place of an earlier one
  int num_unreferenced_vertices = 0;
  int num_degenerate_triangles = 0;  // triangles without area, after welding
  int num_flipped_triangles = 0;     // triangles turned so that their patch faces outward
  int num_boundary_edges = 0;        // edges of one triangle
  int num_non_manifold_edges = 0;    // edges of three triangles or more
  int num_components = 0;            // connected by edges

  bool closed() const { return num_boundary_edges == 0 && num_non_manifold_edges == 0; }
};

// A copy of the mesh, welded and oriented. The user's own mesh and vertex order are untouched.
struct SolidSurface {
  Eigen::Matrix3Xd positions;  // 3 x W, only vertices that a triangle uses
  Eigen::Matrix3Xi triangles;  // 3 x F, consistently oriented, outward
  // V: column of `positions`; -1 = in no triangle, or in such without area alone.
  std::vector<int> vertex_from_input;
  std::vector<int> triangle_components;  // F: component index, numbered by first triangle
  SurfaceReport report;
};

// Makes the copy. Vertices that fall into one cell of a grid of 1e-6 of the box diagonal count as
// one. Patches connected through edges of two triangles are oriented consistently and then outward
// by their signed volume. positions: 3 x V. The error is kInvalidArgument when the counts differ or
// no triangle with area is left.
absl::StatusOr<SolidSurface> PrepareSolidSurface(
    const Topology& topology, const Eigen::Ref<const Eigen::Matrix3Xd>& positions);

}  // namespace pleat
