#include "main_body.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace pleat {
namespace {

// Returns the spheres of `graph` that hang together and hold the most volume, turned.
SphereGraph LargestGroup(const SphereGraph& graph, const Eigen::Matrix3d& turn) {
  std::vector<int> group(graph.size(), -1);
  int best_group = -1;
  double best_volume = 0;
  for (int seed = 0; seed < graph.size(); ++seed) {
    if (group[seed] >= 0) continue;
    double volume = 0;
    for (int i = 0; i < graph.size(); ++i) {
      if (!std::isfinite(graph.PathLength(seed, i))) continue;
      group[i] = seed;
      volume += std::pow(graph.sphere(i).radius, 3);
    }
    if (volume > best_volume) {
      best_volume = volume;
      best_group = seed;
    }
  }
  // The spheres that stay are numbered anew in their old order; an edge is listed from its higher
  // end, when both ends have their numbers.
  std::vector<int> index(graph.size(), -1);
  std::vector<Sphere> spheres;
  std::vector<std::pair<int, int>> edges;
  for (int i = 0; i < graph.size(); ++i) {
    if (group[i] != best_group) continue;
    index[i] = static_cast<int>(spheres.size());
    spheres.push_back({turn * graph.sphere(i).center, graph.sphere(i).radius});
    for (int j : graph.neighbors(i)) {
      if (j < i) edges.push_back({index[j], index[i]});
    }
  }
  return SphereGraph(std::move(spheres), edges);
}

// Finds the components with a triangle whose first corner is next to one of the spheres.
std::vector<char> ComponentsAround(const SphereGraph& graph, const SolidSurface& surface,
                                   const Eigen::Matrix3Xd& positions, double spacing) {
  std::vector<char> is_body(surface.report.num_components, 0);
  for (int f = 0; f < surface.triangles.cols(); ++f) {
    char& known = is_body[surface.triangle_components[f]];
    if (known != 0) continue;
    const Eigen::Vector3d corner = positions.col(surface.triangles(0, f));
    known = std::any_of(graph.spheres().begin(), graph.spheres().end(), [&](const Sphere& sphere) {
      return (sphere.center - corner).norm() < 1.5 * sphere.radius + spacing;
    });
  }
  return is_body;
}

}  // namespace

MainBody FindMainBody(const BodyVolume& volume, int max_spheres,
                      const Eigen::Matrix3d& upright_from_input) {
  const SphereGraph whole(PackSpheres(volume.medial_samples, max_spheres), volume.field);
  MainBody body{LargestGroup(whole, upright_from_input),
                volume.medial_samples,
                upright_from_input * volume.surface.positions,
                {},
                {}};
  for (MedialSample& sample : body.medial_samples) {
    sample.position = upright_from_input * sample.position;
  }
  const SolidSurface& surface = volume.surface;
  body.is_body = ComponentsAround(body.graph, surface, body.positions, volume.field.spacing());
  for (int f = 0; f < surface.triangles.cols(); ++f) {
    if (body.is_body[surface.triangle_components[f]] == 0) continue;
    for (int k = 0; k < 3; ++k) {
      body.bounds.extend(Eigen::Vector3d(body.positions.col(surface.triangles(k, f))));
    }
  }
  return body;
}

}  // namespace pleat
