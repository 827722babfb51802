#include "surface_neighbors.h"

#include <algorithm>
#include <array>
#include <map>
#include <queue>
#include <tuple>
#include <utility>

namespace pleat {
namespace {

struct Edge {
  int vertex;
  double length;
};

std::vector<std::vector<Edge>> EdgeGraph(const Topology& topology,
                                         const Eigen::Matrix3Xd& positions) {
  std::vector<std::pair<int, int>> edges;
  for (int f = 0; f < topology.num_faces(); ++f) {
    const auto face = topology.face(f);
    for (size_t c = 0; c < face.size(); ++c) {
      const int a = face[c], b = face[(c + 1) % face.size()];
      if (a != b) edges.emplace_back(std::min(a, b), std::max(a, b));
    }
  }
  std::map<std::array<double, 3>, int> last_at;  // chain coincident vertices
  for (int v = 0; v < topology.num_vertices(); ++v) {
    const auto [place, is_new] =
        last_at.try_emplace({positions(0, v), positions(1, v), positions(2, v)}, v);
    if (!is_new) edges.emplace_back(std::exchange(place->second, v), v);
  }
  std::sort(edges.begin(), edges.end());
  edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
  std::vector<std::vector<Edge>> graph(topology.num_vertices());
  for (const auto& [a, b] : edges) {
    const double length = (positions.col(a) - positions.col(b)).norm();
    graph[a].push_back({b, length});
    graph[b].push_back({a, length});
  }
  return graph;
}

}  // namespace

std::vector<std::vector<SurfaceNeighbor>> FindSurfaceNeighbors(const Topology& topology,
                                                               const Eigen::Matrix3Xd& positions,
                                                               const std::vector<int>& sources,
                                                               int count) {
  const std::vector<std::vector<Edge>> graph = EdgeGraph(topology, positions);
  std::vector<std::vector<SurfaceNeighbor>> neighbors(graph.size());
  using Entry = std::tuple<double, int, int>;  // distance, source, vertex: ties by source
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
  for (size_t s = 0; s < sources.size(); ++s) queue.emplace(0, static_cast<int>(s), sources[s]);
  while (!queue.empty()) {
    const auto [distance, source, vertex] = queue.top();
    queue.pop();
    std::vector<SurfaceNeighbor>& list = neighbors[vertex];
    if (static_cast<int>(list.size()) >= count) continue;
    const bool known = std::any_of(list.begin(), list.end(),
                                   [source = source](const auto& n) { return n.source == source; });
    // A vertex takes part once for each of its `count` nearest sources. That suffices: on a
    // shortest path to a source, each vertex has that source among its own nearest ones.
    if (known) continue;
    list.push_back({distance, source});
    for (const Edge& edge : graph[vertex]) {
      if (static_cast<int>(neighbors[edge.vertex].size()) < count) {
        queue.emplace(distance + edge.length, source, edge.vertex);
      }
    }
  }
  return neighbors;
}

}  // namespace pleat
