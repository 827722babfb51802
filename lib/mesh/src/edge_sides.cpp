#include "pleat/mesh/edge_sides.h"

#include <algorithm>
#include <tuple>

namespace pleat {
namespace {

void AddSide(int32_t from, int32_t to, int32_t face, std::vector<EdgeSide>* sides) {
  if (from != to) sides->push_back({std::min(from, to), std::max(from, to), face, from < to});
}

// A face may have both sides of an edge; the direction makes the order total.
void Sort(std::vector<EdgeSide>* sides) {
  std::sort(sides->begin(), sides->end(), [](const EdgeSide& a, const EdgeSide& b) {
    return std::tie(a.low, a.high, a.face, a.forward) < std::tie(b.low, b.high, b.face, b.forward);
  });
}

}  // namespace

std::vector<EdgeSide> SortedEdgeSides(const Topology& topology) {
  std::vector<EdgeSide> sides;
  sides.reserve(static_cast<size_t>(topology.num_corners()));
  for (int f = 0; f < topology.num_faces(); ++f) {
    const std::span<const int32_t> corners = topology.face(f);
    for (size_t c = 0; c < corners.size(); ++c) {
      AddSide(corners[c], corners[(c + 1) % corners.size()], f, &sides);
    }
  }
  Sort(&sides);
  return sides;
}

std::vector<EdgeSide> SortedEdgeSides(const Eigen::Matrix3Xi& triangles) {
  std::vector<EdgeSide> sides;
  sides.reserve(static_cast<size_t>(triangles.size()));
  for (int f = 0; f < triangles.cols(); ++f) {
    for (int k = 0; k < 3; ++k) AddSide(triangles(k, f), triangles((k + 1) % 3, f), f, &sides);
  }
  Sort(&sides);
  return sides;
}

size_t EndOfEdge(const std::vector<EdgeSide>& sides, size_t begin) {
  size_t end = begin;
  while (end < sides.size() && sides[end].low == sides[begin].low &&
         sides[end].high == sides[begin].high) {
    ++end;
  }
  return end;
}

}  // namespace pleat
