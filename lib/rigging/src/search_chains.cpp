#include "pleat/rigging/search_chains.h"

#include <algorithm>
#include <numeric>

namespace pleat {
namespace {

constexpr double kOppositeCosine = -0.7;  // neighbors that far apart make a limb, not its end
constexpr size_t kPlacedCandidates = 3;

// Returns the spheres nearest to `place`.
std::vector<int> SpheresNear(const SphereGraph& graph, const Eigen::Vector3d& place) {
  std::vector<int> nearest(graph.size());
  std::iota(nearest.begin(), nearest.end(), 0);
  std::stable_sort(nearest.begin(), nearest.end(), [&](int a, int b) {
    return (graph.sphere(a).center - place).norm() < (graph.sphere(b).center - place).norm();
  });
  nearest.resize(std::min(nearest.size(), kPlacedCandidates));
  return nearest;
}

// Returns the `count` largest spheres, largest first.
std::vector<int> LargestSpheres(const SphereGraph& graph, int count) {
  std::vector<int> by_radius(graph.size());
  std::iota(by_radius.begin(), by_radius.end(), 0);
  std::stable_sort(by_radius.begin(), by_radius.end(),
                   [&](int a, int b) { return graph.sphere(a).radius > graph.sphere(b).radius; });
  by_radius.resize(std::min<size_t>(by_radius.size(), count));
  return by_radius;
}

// The shape goes on behind a sphere with neighbors on opposite sides of it; others are extremities.
bool IsExtremity(const SphereGraph& graph, int sphere) {
  std::vector<Eigen::Vector3d> directions;
  for (const int i : graph.neighbors(sphere)) {
    const Eigen::Vector3d direction =
        (graph.sphere(i).center - graph.sphere(sphere).center).normalized();
    for (const Eigen::Vector3d& other : directions) {
      if (direction.dot(other) < kOppositeCosine) return false;
    }
    directions.push_back(direction);
  }
  return true;
}

}  // namespace

void PlaceOnPath(const SphereGraph& graph, int from, int to, const std::vector<double>& fractions,
                 Eigen::Ref<Eigen::Matrix3Xd> points) {
  // Walks back from the end. The path to a sphere on the way is the first part of this one.
  const double total = graph.PathLength(from, to);
  int after = to;
  for (size_t k = fractions.size(); k-- > 0;) {
    const double target = fractions[k] * total;
    int before = graph.Predecessor(from, after);
    while (before >= 0 && graph.PathLength(from, before) >= target && before != from) {
      after = before;
      before = graph.Predecessor(from, after);
    }
    const Eigen::Vector3d& end = graph.sphere(after).center;
    if (before < 0) {
      points.col(static_cast<Eigen::Index>(k)) = end;
      continue;
    }
    const double start_length = graph.PathLength(from, before);
    const double length = graph.PathLength(from, after) - start_length;
    const double share = length > 0 ? std::clamp((target - start_length) / length, 0.0, 1.0) : 1.0;
    points.col(static_cast<Eigen::Index>(k)) =
        (1 - share) * graph.sphere(before).center + share * end;
  }
}

SearchChains::SearchChains(const SphereGraph& graph, const SearchTree& tree,
                           int max_deep_candidates, const std::vector<PlacedJoint>& placed)
    : candidates_(tree.size()), chains_(tree.size()) {
  const std::vector<int> deep = LargestSpheres(graph, max_deep_candidates);
  std::vector<int> ends;
  for (int i = 0; i < graph.size(); ++i) {
    if (IsExtremity(graph, i)) ends.push_back(i);
  }
  for (size_t j = 0; j < tree.size(); ++j) {
    const auto known = std::ranges::find(placed, tree[j].human_joint, &PlacedJoint::joint);
    if (known != placed.end()) {
      candidates_[j] = SpheresNear(graph, known->position);
    } else if (tree[j].is_deep) {
      candidates_[j] = deep;
    } else if (tree[j].is_leaf) {
      candidates_[j] = ends;
    } else {
      candidates_[j].resize(graph.size());
      std::iota(candidates_[j].begin(), candidates_[j].end(), 0);
    }
    if (tree[j].parent < 0) continue;
    const int mirror = tree[j].mirror;
    if (mirror >= 0 && mirror < static_cast<int>(j) && tree[mirror].parent == tree[j].parent &&
        candidates_[mirror] == candidates_[j] && tree[mirror].fractions == tree[j].fractions) {
      chains_[j] = chains_[mirror];
      continue;
    }
    auto chain = std::make_shared<Chain>();
    chain->num_joints = tree[j].chain.size();
    const std::vector<int>& parents = candidates_[tree[j].parent];
    chain->points.resize(
        3, static_cast<Eigen::Index>(chain->num_joints * parents.size() * candidates_[j].size()));
    Eigen::Index column = 0;
    for (const int parent : parents) {
      for (const int own : candidates_[j]) {
        const auto count = static_cast<Eigen::Index>(chain->num_joints);
        PlaceOnPath(graph, parent, own, tree[j].fractions, chain->points.middleCols(column, count));
        column += count;
      }
    }
    chains_[j] = std::move(chain);
  }
}

}  // namespace pleat
