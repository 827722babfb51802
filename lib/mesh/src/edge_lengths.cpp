#include "pleat/mesh/edge_lengths.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

#include "pleat/mesh/edge_sides.h"

namespace pleat {
namespace {

float Median(std::vector<float> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace

std::vector<Edge> SampleEdges(const Topology& topology, int max_edges) {
  const std::vector<EdgeSide> sides = SortedEdgeSides(topology);
  std::vector<Edge> edges;
  for (size_t begin = 0; begin < sides.size(); begin = EndOfEdge(sides, begin)) {
    edges.push_back({sides[begin].low, sides[begin].high});
  }
  const size_t step = (edges.size() + static_cast<size_t>(max_edges) - 1) /
                      std::max<size_t>(static_cast<size_t>(max_edges), 1);
  if (step <= 1) return edges;
  std::vector<Edge> sample;
  for (size_t e = 0; e < edges.size(); e += step) sample.push_back(edges[e]);
  return sample;
}

std::vector<float> EdgeLengths(const std::vector<Edge>& edges,
                               const Eigen::Ref<const Eigen::Matrix3Xf>& positions) {
  std::vector<float> lengths;
  lengths.reserve(edges.size());
  for (const Edge& edge : edges) {
    lengths.push_back((positions.col(edge.a) - positions.col(edge.b)).stableNorm());
  }
  if (lengths.empty()) return lengths;
  const float floor = std::max(0.05f * Median(lengths), std::numeric_limits<float>::min());
  for (float& length : lengths) length = std::max(length, floor);
  return lengths;
}

EdgeChange CompareEdgeLengths(const std::vector<float>& before, const std::vector<float>& after) {
  assert(before.size() == after.size());
  EdgeChange change;
  if (before.empty()) return change;
  std::vector<float> ratios(before.size());
  for (size_t e = 0; e < before.size(); ++e) ratios[e] = after[e] / before[e];
  const float scale = Median(ratios);
  if (!(scale > 0) || !std::isfinite(scale)) return change;
  change.scale = scale;
  int num_moderate = 0, num_large = 0, num_extreme = 0;
  for (const float ratio : ratios) {
    const float off = ratio > scale ? ratio / scale : scale / ratio;
    num_moderate += off > 1.3f;
    num_large += off > 2;
    num_extreme += off > 4;
  }
  const auto num_edges = static_cast<double>(before.size());
  change.share_moderate = num_moderate / num_edges;
  change.share_large = num_large / num_edges;
  change.share_extreme = num_extreme / num_edges;
  return change;
}

}  // namespace pleat
