#include "main_body.h"

#include <cmath>
#include <numbers>
#include <utility>

#include "pleat/mesh/bounds.h"

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

}  // namespace

MainBody FindMainBody(const BodyVolume& volume, int max_spheres,
                      const Eigen::Matrix3d& upright_from_input) {
  const SphereGraph whole(PackSpheres(volume.medial_samples, max_spheres), volume.field);
  const BodyShell& shell = volume.body->shell;
  MainBody body{LargestGroup(whole, upright_from_input),
                volume.medial_samples,
                {upright_from_input * shell.positions, shell.triangles},
                {}};
  for (MedialSample& sample : body.medial_samples) {
    sample.position = upright_from_input * sample.position;
  }
  body.bounds = ComputeBounds(body.shell.positions);
  return body;
}

double HorizontalAxisYaw(const BodyShell& shell, const Eigen::Matrix3d& upright_from_shell) {
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  Eigen::Matrix2d products = Eigen::Matrix2d::Zero();
  double total = 0;
  for (Eigen::Index f = 0; f < shell.triangles.cols(); ++f) {
    Eigen::Matrix<double, 2, 3> corners;
    Eigen::Matrix3d places;
    for (int k = 0; k < 3; ++k) {
      places.col(k) = upright_from_shell * shell.positions.col(shell.triangles(k, f));
      corners.col(k) << places(0, k), places(2, k);
    }
    const double area = (places.col(1) - places.col(0)).cross(places.col(2) - places.col(0)).norm();
    const Eigen::Vector2d corner_sum = corners.rowwise().sum();
    sum += area / 3 * corner_sum;
    // The second moment of a triangle, exactly.
    products += area / 12 * (corners * corners.transpose() + corner_sum * corner_sum.transpose());
    total += area;
  }
  const Eigen::Matrix2d covariance = products / total - sum * sum.transpose() / (total * total);
  // The direction of the larger eigenvalue of a symmetric 2 x 2 matrix.
  const double angle = .5 * std::atan2(2 * covariance(0, 1), covariance(0, 0) - covariance(1, 1));
  return angle > 0 ? std::numbers::pi - angle : -angle;
}

}  // namespace pleat
