// Tells which vertices share an edge.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "pleat/mesh/topology.h"

namespace pleat {

// The neighbors of every vertex along polygon edges, ascending and without repetition. Immutable.
class VertexAdjacency {
 public:
  explicit VertexAdjacency(const Topology& topology);

  int num_vertices() const { return static_cast<int>(starts_.size()) - 1; }
  std::span<const int32_t> neighbors(int v) const {
    return std::span(neighbors_).subspan(starts_[v], starts_[v + 1] - starts_[v]);
  }

 private:
  std::vector<int32_t> starts_;  // num_vertices + 1
  std::vector<int32_t> neighbors_;
};

}  // namespace pleat
