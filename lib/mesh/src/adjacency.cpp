#include "pleat/mesh/adjacency.h"

#include <algorithm>
#include <utility>

namespace pleat {

VertexAdjacency::VertexAdjacency(const Topology& topology) {
  std::vector<std::pair<int32_t, int32_t>> pairs;  // (vertex, neighbor), both directions
  pairs.reserve(2 * static_cast<size_t>(topology.num_corners()));
  for (int f = 0; f < topology.num_faces(); ++f) {
    const std::span<const int32_t> corners = topology.face(f);
    for (size_t c = 0; c < corners.size(); ++c) {
      const int32_t a = corners[c], b = corners[(c + 1) % corners.size()];
      if (a == b) continue;
      pairs.emplace_back(a, b);
      pairs.emplace_back(b, a);
    }
  }
  // Sorted pairs are the lists already, one vertex after the other: only the starts are missing.
  std::sort(pairs.begin(), pairs.end());
  pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
  starts_.assign(static_cast<size_t>(topology.num_vertices()) + 1, 0);
  neighbors_.reserve(pairs.size());
  for (const auto& [vertex, neighbor] : pairs) {
    ++starts_[static_cast<size_t>(vertex) + 1];
    neighbors_.push_back(neighbor);
  }
  for (size_t v = 1; v < starts_.size(); ++v) starts_[v] += starts_[v - 1];
}

}  // namespace pleat
