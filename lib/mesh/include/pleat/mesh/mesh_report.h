// The pre-flight: what is unclean about a mesh, before it is rigged. Nothing is repaired or
// reordered (docs/method/rig.md#pre-flight).
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <string>
#include <vector>

#include "pleat/mesh/topology.h"

namespace pleat {

struct MeshReport {
  int num_vertices = 0;
  int num_faces = 0;
  int num_triangles = 0;
  int num_components = 0;             // parts joined by faces; unreferenced vertices not counted
  int num_welded_components = 0;      // the same when vertices at one place count as one
  int num_boundary_edges = 0;         // edges of one face
  int num_non_manifold_edges = 0;     // edges of three or more faces
  int num_inconsistent_edges = 0;     // edges whose two faces run along them the same way
  int num_unreferenced_vertices = 0;  // vertices that no face uses
  int num_duplicate_vertices = 0;     // vertices at exactly the place of an earlier one
  int num_degenerate_faces = 0;       // a corner twice, or area below 1e-12 diagonal^2
  double signed_volume_m3 = 0;        // > 0: faces outwards; exact for closed meshes only
  Eigen::AlignedBox3d bounds;         // box of all vertices, meters

  bool closed() const { return num_boundary_edges == 0 && num_non_manifold_edges == 0; }
};

// Inspects a mesh in one frame. positions: 3 x V, finite.
MeshReport InspectMesh(const Topology& topology,
                       const Eigen::Ref<const Eigen::Matrix3Xd>& positions);

// Returns one sentence for each thing that is unclean; nothing for a clean closed mesh of one part.
std::vector<std::string> DescribeFaults(const MeshReport& report);

}  // namespace pleat
