// How the lengths of a mesh's edges differ between two shapes: the statistic by which shapes are
// compared vertex by vertex.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "pleat/mesh/topology.h"

namespace pleat {

struct Edge {
  int32_t a = 0, b = 0;
};

// Edges of the polygons, each once; of more than `max_edges` every n-th.
std::vector<Edge> SampleEdges(const Topology& topology, int max_edges);

// Lengths, one for each edge. Each is at least 5 % of their median, so that edges that are nearly
// degenerate do not count as changed when rounding moves their ends.
std::vector<float> EdgeLengths(const std::vector<Edge>& edges,
                               const Eigen::Ref<const Eigen::Matrix3Xf>& positions);

struct EdgeChange {
  double scale = 1;           // median of the lengths' ratios
  double share_moderate = 0;  // edges whose ratio is off the median by a factor of more than 1.3
  double share_large = 0;     // ... of more than 2
  double share_extreme = 0;   // ... of more than 4
};

// What changed from the lengths `before` to the lengths `after` of the same edges.
EdgeChange CompareEdgeLengths(const std::vector<float>& before, const std::vector<float>& after);

}  // namespace pleat
