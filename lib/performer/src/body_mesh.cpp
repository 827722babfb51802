#include "body_mesh.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "pleat/base/status.h"
#include "remesh.h"

namespace pleat {
namespace {

using Eigen::Vector3d;

constexpr double kGridSpacing = .0095;  // resolves hands and feet; independent of the wanted count

// Returns the edge length of the torso at which an isotropic mesh of this surface has
// `num_vertices`: each vertex stands for two equilateral triangles.
double EdgeLengthFor(const CharacterShape& shape, const TriangleSoup& soup, int num_vertices) {
  double relative_area = 0;
  for (const std::array<int, 3>& t : soup.triangles) {
    const Vector3d& a = soup.positions[t[0]];
    const double area = (soup.positions[t[1]] - a).cross(soup.positions[t[2]] - a).norm() / 2;
    const double relative = shape.RelativeEdgeLength(a);
    relative_area += area / (relative * relative);
  }
  return std::sqrt(relative_area / num_vertices * 2 / std::sqrt(3.));
}

// Checks that every directed edge occurs once and with its reverse, that there is one component,
// and that the Euler characteristic is 2. Remeshing keeps all of it; this is the proof.
absl::Status CheckClosedSphere(const TriangleSoup& soup) {
  std::map<std::pair<int, int>, int> directed;
  std::vector<int> parent(soup.positions.size());
  for (size_t v = 0; v < parent.size(); ++v) parent[v] = static_cast<int>(v);
  const auto find = [&](int v) {
    while (parent[v] != v) v = parent[v] = parent[parent[v]];
    return v;
  };
  for (const std::array<int, 3>& t : soup.triangles) {
    for (int c = 0; c < 3; ++c) {
      ++directed[{t[c], t[(c + 1) % 3]}];
      parent[find(t[c])] = find(t[(c + 1) % 3]);
    }
  }
  for (const auto& [edge, count] : directed) {
    if (count != 1 || !directed.contains({edge.second, edge.first})) {
      return absl::InternalError(
          "performer: the generated surface is not a closed manifold; "
          "choose another number of vertices or character seed");
    }
  }
  int num_components = 0;
  for (size_t v = 0; v < parent.size(); ++v) num_components += parent[v] == static_cast<int>(v);
  const long characteristic = static_cast<long>(soup.positions.size()) -
                              static_cast<long>(directed.size() / 2) +
                              static_cast<long>(soup.triangles.size());
  if (num_components != 1 || characteristic != 2) {
    return absl::InternalError(
        "performer: the generated surface is not one sphere-like component; "
        "choose another number of vertices or character seed");
  }
  return absl::OkStatus();
}

}  // namespace

absl::StatusOr<TriangleSoup> BuildBodyMesh(const CharacterShape& shape, int num_vertices,
                                           const Progress& progress) {
  RemeshOptions options;
  options.distance = [&](const Vector3d& p) { return shape.Distance(p); };
  const auto [low, high] = shape.bounds();
  PLEAT_ASSIGN_OR_RETURN(TriangleSoup soup,
                         ExtractIsosurface(options.distance, low, high, kGridSpacing,
                                           progress.Stage("polygonize", 0, .3)));
  // The isosurface is much finer than the wanted mesh and its triangles are slivers; remeshing
  // makes the mesh, the isosurface only gives it the right topology.
  double edge_length = EdgeLengthFor(shape, soup, num_vertices);
  options.edge_length = [&](const Vector3d& p) {
    return edge_length * shape.RelativeEdgeLength(p);
  };
  PLEAT_ASSIGN_OR_RETURN(
      soup, RemeshIsotropic(std::move(soup), options, progress.Stage("remesh", .3, .7)));
  // The count comes out a little off the estimate; further rounds correct it.
  options.num_iterations = 4;
  for (int round = 0; round < 3; ++round) {
    const double ratio = static_cast<double>(soup.positions.size()) / num_vertices;
    if (std::abs(ratio - 1) < .02) break;
    edge_length *= std::sqrt(ratio);
    PLEAT_ASSIGN_OR_RETURN(
        soup, RemeshIsotropic(std::move(soup), options,
                              progress.Stage("remesh", .7 + .1 * round, .8 + .1 * round)));
  }
  PLEAT_RETURN_IF_ERROR(CheckClosedSphere(soup));
  return soup;
}

}  // namespace pleat
