#include "pleat/rigging/sphere_graph.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <queue>
#include <utility>

namespace pleat {
namespace {

// Returns true when the ball over the segment from i to j holds no third center.
bool IsGabrielEmpty(const std::vector<Sphere>& spheres, size_t i, size_t j) {
  const Eigen::Vector3d middle = 0.5 * (spheres[i].center + spheres[j].center);
  const double squared_reach = (spheres[i].center - middle).squaredNorm();
  for (size_t k = 0; k < spheres.size(); ++k) {
    if (k != i && k != j && (spheres[k].center - middle).squaredNorm() < squared_reach) {
      return false;
    }
  }
  return true;
}

}  // namespace

SphereGraph::SphereGraph(std::vector<Sphere> spheres, const DistanceField& field)
    : spheres_(std::move(spheres)), neighbors_(spheres_.size()) {
  for (size_t i = 0; i < spheres_.size(); ++i) {
    for (size_t j = i + 1; j < spheres_.size(); ++j) {
      const Sphere &a = spheres_[i], &b = spheres_[j];
      const double length = (a.center - b.center).norm();
      const bool overlap = length < a.radius + b.radius;
      if (!overlap &&
          !(IsGabrielEmpty(spheres_, i, j) &&
            field.MaxAlongSegment(a.center, b.center) <= -0.5 * std::min(a.radius, b.radius))) {
        continue;
      }
      neighbors_[i].push_back(static_cast<int>(j));
      neighbors_[j].push_back(static_cast<int>(i));
    }
  }
  ComputeShortestPaths();
}

SphereGraph::SphereGraph(std::vector<Sphere> spheres, const std::vector<std::pair<int, int>>& edges)
    : spheres_(std::move(spheres)), neighbors_(spheres_.size()) {
  for (const auto& [i, j] : edges) {
    neighbors_[i].push_back(j);
    neighbors_[j].push_back(i);
  }
  ComputeShortestPaths();
}

SphereGraph SphereGraph::LargestGroup() const {
  std::vector<char> is_seen(spheres_.size(), 0);
  std::vector<int> kept;
  double most_volume = 0;
  for (int seed = 0; seed < size(); ++seed) {
    if (is_seen[seed] != 0) continue;
    std::vector<int> group;
    double volume = 0;
    for (int i = 0; i < size(); ++i) {
      if (!std::isfinite(PathLength(seed, i))) continue;
      is_seen[i] = 1;
      group.push_back(i);
      volume += std::pow(spheres_[i].radius, 3);
    }
    if (volume > most_volume) {
      most_volume = volume;
      kept = std::move(group);
    }
  }
  if (static_cast<int>(kept.size()) == size()) return *this;
  // Paths do not leave a group, so those of the spheres that stay are known.
  std::vector<int> index(spheres_.size(), -1);
  for (size_t k = 0; k < kept.size(); ++k) index[kept[k]] = static_cast<int>(k);
  SphereGraph group;
  for (const int i : kept) {
    group.spheres_.push_back(spheres_[i]);
    group.neighbors_.emplace_back();
    for (const int j : neighbors_[i]) group.neighbors_.back().push_back(index[j]);
  }
  group.distances_ = distances_(kept, kept);
  group.predecessors_ =
      predecessors_(kept, kept).unaryExpr([&](int i) { return i < 0 ? -1 : index[i]; });
  return group;
}

SphereGraph SphereGraph::Turned(const Eigen::Matrix3d& turn) const {
  SphereGraph turned = *this;
  for (Sphere& sphere : turned.spheres_) sphere.center = turn * sphere.center;
  return turned;
}

// Dijkstra from every sphere. Ties go to the path that was found first, in the order of neighbors,
// so the paths are the same everywhere.
void SphereGraph::ComputeShortestPaths() {
  const int num = size();
  distances_.setConstant(num, num, std::numeric_limits<double>::infinity());
  predecessors_.setConstant(num, num, -1);
  using Entry = std::pair<double, int>;
  for (int start = 0; start < num; ++start) {
    std::priority_queue<Entry, std::vector<Entry>, std::greater<Entry>> queue;
    distances_(start, start) = 0;
    queue.push({0, start});
    while (!queue.empty()) {
      const auto [length, i] = queue.top();
      queue.pop();
      if (length > distances_(i, start)) continue;
      for (int j : neighbors_[i]) {
        const double through = length + (spheres_[i].center - spheres_[j].center).norm();
        if (through < distances_(j, start)) {
          distances_(j, start) = through;
          predecessors_(j, start) = i;
          queue.push({through, j});
        }
      }
    }
  }
}

std::vector<int> SphereGraph::Path(int from, int to) const {
  std::vector<int> path;
  if (from != to && predecessors_(to, from) < 0) return path;
  for (int i = to; i >= 0; i = predecessors_(i, from)) path.push_back(i);
  std::reverse(path.begin(), path.end());
  return path;
}

}  // namespace pleat
