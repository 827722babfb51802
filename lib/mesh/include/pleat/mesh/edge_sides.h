// The edges of a surface, each with the faces that run along it.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "pleat/mesh/topology.h"

namespace pleat {

// A face runs along the edge between the vertices `low` and `high`.
struct EdgeSide {
  int32_t low = 0, high = 0;  // low < high
  int32_t face = 0;
  bool forward = false;  // the face runs from `low` to `high`
};

// All sides, by edge and then by face. A face that names one vertex twice in a row has no edge
// there.
std::vector<EdgeSide> SortedEdgeSides(const Topology& topology);
std::vector<EdgeSide> SortedEdgeSides(const Eigen::Matrix3Xi& triangles);

// The sides of the edge at `begin` are [begin, result) of sorted sides: one at a boundary, two on a
// manifold surface, more where it branches.
size_t EndOfEdge(const std::vector<EdgeSide>& sides, size_t begin);

}  // namespace pleat
