#include "pleat/geometry/control_topology.h"

#include <algorithm>
#include <array>
#include <functional>
#include <limits>
#include <queue>
#include <set>
#include <utility>

#include "absl/strings/str_cat.h"
#include "pleat/mesh/adjacency.h"

namespace pleat {
namespace {

// Returns for each vertex the number (in control_vertices) of the nearest control vertex, -1 where
// no path leads. Dijkstra's algorithm from all control vertices at once; labels are compared with
// the cell as second key, so that ties do not depend on the order of the queue.
std::vector<int> VoronoiCells(const Topology& topology, const Eigen::Matrix3Xd& reference,
                              const std::vector<int>& control_vertices) {
  const VertexAdjacency adjacency(topology);
  struct Label {
    double distance = std::numeric_limits<double>::infinity();
    int cell = -1;
    bool operator<(const Label& other) const {
      return std::pair(distance, cell) < std::pair(other.distance, other.cell);
    }
  };
  std::vector<Label> labels(topology.num_vertices());
  using Entry = std::pair<std::pair<double, int>, int>;  // (distance, cell), vertex
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
  for (size_t i = 0; i < control_vertices.size(); ++i) {
    labels[control_vertices[i]] = {0, static_cast<int>(i)};
    queue.push({{0, static_cast<int>(i)}, control_vertices[i]});
  }
  while (!queue.empty()) {
    const auto [key, v] = queue.top();
    queue.pop();
    if (key != std::pair(labels[v].distance, labels[v].cell)) continue;
    for (const int32_t n : adjacency.neighbors(v)) {
      const Label label = {key.first + (reference.col(n) - reference.col(v)).norm(), key.second};
      if (!(label < labels[n])) continue;
      labels[n] = label;
      queue.push({{label.distance, label.cell}, n});
    }
  }
  std::vector<int> cells;
  for (const Label& label : labels) cells.push_back(label.cell);
  return cells;
}

}  // namespace

absl::StatusOr<Topology> ControlTopology(const Topology& topology,
                                         const Eigen::Matrix3Xd& reference,
                                         const std::vector<int>& control_vertices) {
  if (reference.cols() != topology.num_vertices()) {
    return absl::InvalidArgumentError(absl::StrCat("control mesh: the reference frame has ",
                                                   reference.cols(), " vertices, the topology has ",
                                                   topology.num_vertices()));
  }
  for (const int v : control_vertices) {
    if (v < 0 || v >= topology.num_vertices()) {
      return absl::InvalidArgumentError(
          absl::StrCat("control mesh: vertex ", v, " is not in the mesh"));
    }
  }
  const std::vector<int> cells = VoronoiCells(topology, reference, control_vertices);
  std::set<std::array<int, 3>> seen;  // three cells may meet in several places
  std::vector<std::array<int, 3>> triangles;
  for (int f = 0; f < topology.num_triangles(); ++f) {
    std::array<int, 3> triangle;
    for (int c = 0; c < 3; ++c) triangle[c] = cells[topology.triangles()(c, f)];
    std::array<int, 3> sorted = triangle;
    std::sort(sorted.begin(), sorted.end());
    if (sorted[0] < 0 || sorted[0] == sorted[1] || sorted[1] == sorted[2]) continue;
    if (seen.insert(sorted).second) triangles.push_back(triangle);
  }
  Eigen::Matrix3Xi columns(3, triangles.size());
  for (size_t t = 0; t < triangles.size(); ++t) {
    columns.col(static_cast<Eigen::Index>(t)) << triangles[t][0], triangles[t][1], triangles[t][2];
  }
  return Topology::FromTriangles(static_cast<int>(control_vertices.size()), columns);
}

}  // namespace pleat
