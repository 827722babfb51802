// Triangles over the control vertices (docs/method/details.md#control-mesh).
#pragma once

#include <Eigen/Core>
#include <vector>

#include "absl/status/statusor.h"
#include "pleat/mesh/topology.h"

namespace pleat {

// Returns the dual of the control vertices' geodesic Voronoi cells (Okabe, Boots, Sugihara, Chiu:
// Spatial Tessellations, 2000; on meshes Dyer, Zhang, Moeller 2007): every triangle of `topology`
// whose corners lie in three cells gives one triangle of their control vertices, oriented alike.
// Distances are shortest paths along edges in the frame `reference` (3 x V, meters); ties go to the
// lower control vertex. Vertex i of the result is control_vertices[i]. Deterministic. The error is
// kInvalidArgument when a control vertex is not in the mesh or the counts differ.
absl::StatusOr<Topology> ControlTopology(const Topology& topology,
                                         const Eigen::Matrix3Xd& reference,
                                         const std::vector<int>& control_vertices);

}  // namespace pleat
