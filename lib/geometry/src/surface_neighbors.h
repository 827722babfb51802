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

// For every vertex the `count` nearest of `sources` (distinct vertex indices), nearest first, by
// shortest paths along edges (Dijkstra from all sources at once). Vertices at exactly the same
// place are joined (seams). Fewer where a component holds fewer sources, none where it holds none.
std::vector<std::vector<SurfaceNeighbor>> FindSurfaceNeighbors(const Topology& topology,
                                                               const Eigen::Matrix3Xd& positions,
                                                               const std::vector<int>& sources,
                                                               int count);

}  // namespace pleat
