// Nearest sources along the edges of a mesh, so that nothing bleeds across a gap of air.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "pleat/mesh/topology.h"

namespace pleat {

struct SurfaceNeighbor {
  double distance = 0;  // along edges, meters
  int source = 0;       // position in the list of source vertices
};

// Returns for every vertex the `count` nearest of `sources` (distinct vertex indices), nearest
// first, by shortest paths along edges (Dijkstra from all sources at once). Vertices at exactly the
// same place are joined (seams). There are fewer where a component holds fewer sources, and none
// where it holds none. Costs O(count * E log(count * E)) for E edges.
std::vector<std::vector<SurfaceNeighbor>> FindSurfaceNeighbors(const Topology& topology,
                                                               const Eigen::Matrix3Xd& positions,
                                                               const std::vector<int>& sources,
                                                               int count);

}  // namespace pleat
