#include "pleat/geometry/solid_surface.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <utility>

#include "absl/strings/str_cat.h"
#include "pleat/mesh/bounds.h"
#include "pleat/mesh/edge_sides.h"

namespace pleat {
namespace {

constexpr double kWeldFraction = 1e-6;

// Returns for every vertex the first vertex (in index order) at the same place. Places are rounded
// to a grid, so two vertices nearer than a cell may still fall into two of them; that leaves a
// seam, which the winding number does not mind.
std::vector<int> WeldByPosition(const Eigen::Ref<const Eigen::Matrix3Xd>& positions) {
  const int num_vertices = static_cast<int>(positions.cols());
  const Eigen::AlignedBox3d box = ComputeBounds(positions);
  const double cell = std::max(box.diagonal().norm() * kWeldFraction, 1e-300);
  using Key = std::array<int64_t, 3>;
  std::vector<std::pair<Key, int>> keys(num_vertices);
  for (int v = 0; v < num_vertices; ++v) {
    for (int k = 0; k < 3; ++k) {
      keys[v].first[k] = std::llround((positions(k, v) - box.min()[k]) / cell);
    }
    keys[v].second = v;
  }
  std::sort(keys.begin(), keys.end());
  std::vector<int> first_vertex(num_vertices);
  for (int i = 0, start = 0; i < num_vertices; ++i) {
    if (keys[i].first != keys[start].first) start = i;
    first_vertex[keys[i].second] = keys[start].second;
  }
  return first_vertex;
}

void KeepUsableTriangles(const Topology& topology,
                         const Eigen::Ref<const Eigen::Matrix3Xd>& positions,
                         SolidSurface* surface) {
  const int num_vertices = topology.num_vertices();
  const std::vector<int> welded = WeldByPosition(positions);
  std::vector<char> referenced(num_vertices, 0), is_used(num_vertices, 0);
  std::vector<Eigen::Vector3i> kept;
  for (int f = 0; f < topology.num_triangles(); ++f) {
    Eigen::Vector3i triangle = topology.triangles().col(f);
    for (int k = 0; k < 3; ++k) {
      referenced[triangle[k]] = 1;
      triangle[k] = welded[triangle[k]];
    }
    const Eigen::Vector3d a = positions.col(triangle[0]);
    const double doubled_area = (Eigen::Vector3d(positions.col(triangle[1])) - a)
                                    .cross(Eigen::Vector3d(positions.col(triangle[2])) - a)
                                    .norm();
    if (!(doubled_area > 0)) {
      ++surface->report.num_degenerate_triangles;
      continue;
    }
    for (const int vertex : triangle) is_used[vertex] = 1;
    kept.push_back(triangle);
  }
  std::vector<int> column(num_vertices, -1);
  std::vector<int> sources;
  for (int v = 0; v < num_vertices; ++v) {
    if (!referenced[v]) {
      ++surface->report.num_unreferenced_vertices;
      continue;
    }
    surface->report.num_welded_vertices += welded[v] != v;
    if (is_used[welded[v]] != 0 && column[welded[v]] < 0) {
      column[welded[v]] = static_cast<int>(sources.size());
      sources.push_back(welded[v]);
    }
  }
  surface->vertex_from_input.assign(num_vertices, -1);
  for (int v = 0; v < num_vertices; ++v) {
    if (referenced[v]) surface->vertex_from_input[v] = column[welded[v]];
  }
  surface->positions.resize(3, sources.size());
  for (size_t i = 0; i < sources.size(); ++i) surface->positions.col(i) = positions.col(sources[i]);
  surface->triangles.resize(3, kept.size());
  for (size_t f = 0; f < kept.size(); ++f) {
    for (int k = 0; k < 3; ++k) surface->triangles(k, f) = column[kept[f][k]];
  }
}

struct Neighbor {
  int triangle;
  bool same_orientation;
  bool is_manifold;  // across an edge of exactly two triangles
};

std::vector<std::vector<Neighbor>> TriangleNeighbors(const std::vector<EdgeSide>& sides,
                                                     int num_triangles, SurfaceReport* report) {
  std::vector<std::vector<Neighbor>> neighbors(num_triangles);
  for (size_t start = 0, end = 0; start < sides.size(); start = end) {
    end = EndOfEdge(sides, start);
    report->num_boundary_edges += end - start == 1;
    report->num_non_manifold_edges += end - start > 2;
    for (size_t i = start; i + 1 < end; ++i) {
      const EdgeSide &a = sides[i], &b = sides[i + 1];
      const bool same = a.forward != b.forward;
      neighbors[a.face].push_back({b.face, same, end - start == 2});
      neighbors[b.face].push_back({a.face, same, end - start == 2});
    }
  }
  return neighbors;
}

// Returns six times the signed volume of `patch` seen from its own center, so that the sign has a
// meaning for open patches too.
double SignedVolume(const SolidSurface& surface, const std::vector<int>& patch) {
  Eigen::Vector3d center = Eigen::Vector3d::Zero();
  for (int f : patch) {
    for (int k = 0; k < 3; ++k) center += surface.positions.col(surface.triangles(k, f));
  }
  center /= 3.0 * patch.size();
  double volume = 0;
  for (int f : patch) {
    const Eigen::Vector3d a = surface.positions.col(surface.triangles(0, f)) - center;
    const Eigen::Vector3d b = surface.positions.col(surface.triangles(1, f)) - center;
    const Eigen::Vector3d c = surface.positions.col(surface.triangles(2, f)) - center;
    volume += a.dot(b.cross(c));
  }
  return volume;
}

// Grows each patch breadth first from its lowest triangle. `flipped` is relative to the input, so
// two neighbors agree when they had the same orientation and both or neither are flipped.
void OrientPatches(const std::vector<std::vector<Neighbor>>& neighbors, SolidSurface* surface) {
  const int num_triangles = static_cast<int>(surface->triangles.cols());
  std::vector<char> visited(num_triangles, 0), flipped(num_triangles, 0);
  const auto flip = [&](int f) {
    std::swap(surface->triangles(1, f), surface->triangles(2, f));
    flipped[f] ^= 1;
  };
  for (int seed = 0; seed < num_triangles; ++seed) {
    if (visited[seed]) continue;
    std::vector<int> patch = {seed};
    visited[seed] = 1;
    for (size_t i = 0; i < patch.size(); ++i) {
      for (const Neighbor& neighbor : neighbors[patch[i]]) {
        if (!neighbor.is_manifold || visited[neighbor.triangle]) continue;
        visited[neighbor.triangle] = 1;
        if (neighbor.same_orientation == (flipped[patch[i]] != 0)) flip(neighbor.triangle);
        patch.push_back(neighbor.triangle);
      }
    }
    if (SignedVolume(*surface, patch) < 0) {
      for (int f : patch) flip(f);
    }
  }
  for (char was_flipped : flipped) surface->report.num_flipped_triangles += was_flipped;
}

void NumberComponents(const std::vector<std::vector<Neighbor>>& neighbors, SolidSurface* surface) {
  std::vector<int>& components = surface->triangle_components;
  components.assign(neighbors.size(), -1);
  std::vector<int> stack;
  for (size_t seed = 0; seed < neighbors.size(); ++seed) {
    if (components[seed] >= 0) continue;
    components[seed] = surface->report.num_components;
    stack = {static_cast<int>(seed)};
    while (!stack.empty()) {
      const int f = stack.back();
      stack.pop_back();
      for (const Neighbor& neighbor : neighbors[f]) {
        if (components[neighbor.triangle] >= 0) continue;
        components[neighbor.triangle] = surface->report.num_components;
        stack.push_back(neighbor.triangle);
      }
    }
    ++surface->report.num_components;
  }
}

}  // namespace

absl::StatusOr<SolidSurface> PrepareSolidSurface(
    const Topology& topology, const Eigen::Ref<const Eigen::Matrix3Xd>& positions) {
  if (positions.cols() != topology.num_vertices()) {
    return absl::InvalidArgumentError(absl::StrCat(
        positions.cols(), " positions for a topology of ", topology.num_vertices(), " vertices"));
  }
  SolidSurface surface;
  KeepUsableTriangles(topology, positions, &surface);
  const int num_triangles = static_cast<int>(surface.triangles.cols());
  if (num_triangles == 0) {
    return absl::InvalidArgumentError(
        absl::StrCat("none of the ", topology.num_triangles(),
                     " triangles has an area: the mesh encloses nothing"));
  }
  const std::vector<EdgeSide> sides = SortedEdgeSides(surface.triangles);
  const std::vector<std::vector<Neighbor>> neighbors =
      TriangleNeighbors(sides, num_triangles, &surface.report);
  OrientPatches(neighbors, &surface);
  NumberComponents(neighbors, &surface);
  return surface;
}

}  // namespace pleat
