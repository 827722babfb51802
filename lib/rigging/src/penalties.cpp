#include "pleat/rigging/penalties.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "pleat/skeleton/human_template.h"

namespace pleat {
namespace {

constexpr double kOppositeCosine = -0.7;  // neighbors that far apart make a limb, not its end
constexpr size_t kPlacedCandidates = 3;
constexpr double kInfinite = std::numeric_limits<double>::infinity();

double Square(double x) { return x * x; }

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

// Returns 0 for equal directions, .09 at 45 degrees (arms of a T-pose against the template's), 2 at
// a right angle, 10 for opposite ones, and that of a right angle when one has no length.
double DirectionMismatch(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  const double lengths = a.norm() * b.norm();
  const double turn = lengths > 1e-12 ? 1 - a.dot(b) / lengths : 1;
  return Square(turn) + 2 * Square(std::max(0.0, turn - 0.3));
}

}  // namespace

Eigen::Matrix3Xd PointsAlongPath(const SphereGraph& graph, const std::vector<int>& path,
                                 const std::vector<double>& fractions) {
  double total = 0;
  for (size_t i = 1; i < path.size(); ++i) {
    total += (graph.sphere(path[i]).center - graph.sphere(path[i - 1]).center).norm();
  }
  Eigen::Matrix3Xd points(3, fractions.size());
  size_t segment = 1;
  double before = 0;
  for (size_t k = 0; k < fractions.size(); ++k) {
    if (path.size() < 2) {
      points.col(k) = graph.sphere(path[0]).center;
      continue;
    }
    const double target = fractions[k] * total;
    double length = 0;
    for (;; ++segment) {
      length = (graph.sphere(path[segment]).center - graph.sphere(path[segment - 1]).center).norm();
      if (before + length >= target || segment + 1 == path.size()) break;
      before += length;
    }
    const double share = length > 0 ? std::clamp((target - before) / length, 0.0, 1.0) : 1.0;
    points.col(k) = (1 - share) * graph.sphere(path[segment - 1]).center +
                    share * graph.sphere(path[segment]).center;
  }
  return points;
}

PenaltyModel::PenaltyModel(const SphereGraph& graph, const SearchTree& tree, double floor_height,
                           double body_size, const PenaltyOptions& options)
    : graph_(graph),
      tree_(tree),
      floor_height_(floor_height),
      body_size_(body_size),
      options_(options),
      candidates_(tree.size()) {
  std::vector<int> by_radius(graph.size());
  std::iota(by_radius.begin(), by_radius.end(), 0);
  std::stable_sort(by_radius.begin(), by_radius.end(),
                   [&](int a, int b) { return graph.sphere(a).radius > graph.sphere(b).radius; });
  for (size_t j = 0; j < tree.size(); ++j) {
    const auto placed = std::ranges::find(options.placed, tree[j].human_joint, &PlacedJoint::joint);
    if (placed != options.placed.end()) {
      candidates_[j] = SpheresNear(graph, placed->position);
      continue;
    }
    if (tree[j].is_deep) {
      const size_t count = std::min<size_t>(by_radius.size(), options.max_deep_candidates);
      candidates_[j].assign(by_radius.begin(), by_radius.begin() + count);
      continue;
    }
    for (int i = 0; i < graph.size(); ++i) {
      if (!tree[j].is_leaf || IsExtremity(i)) candidates_[j].push_back(i);
    }
  }
}

// The shape goes on behind a sphere with neighbors on opposite sides of it; others are extremities.
bool PenaltyModel::IsExtremity(int sphere) const {
  std::vector<Eigen::Vector3d> directions;
  for (int i : graph_.neighbors(sphere)) {
    const Eigen::Vector3d direction =
        (graph_.sphere(i).center - graph_.sphere(sphere).center).normalized();
    for (const Eigen::Vector3d& other : directions) {
      if (direction.dot(other) < kOppositeCosine) return false;
    }
    directions.push_back(direction);
  }
  return true;
}

double PenaltyModel::LocalDirection(const SearchJoint& joint, const std::vector<int>& path) const {
  const Eigen::Matrix3Xd points = PointsAlongPath(graph_, path, joint.fractions);
  Eigen::Vector3d start = graph_.sphere(path[0]).center;
  double mismatch = 0;
  for (size_t k = 0; k < joint.chain.size(); ++k) {
    double bone = DirectionMismatch(points.col(k) - start, joint.directions.col(k));
    if (joint.chain[k] == kLeftHand || joint.chain[k] == kRightHand) {
      bone = std::min(bone, options_.most_forearm_mismatch);
    }
    mismatch += joint.bone_lengths[k] / joint.length * bone;
    start = points.col(k);
  }
  return mismatch;
}

double PenaltyModel::LeafPenalty(int sphere, int parent_sphere,
                                 const std::vector<int>& path) const {
  if (path.size() < 2) return 1;
  const Eigen::Vector3d& center = graph_.sphere(sphere).center;
  const Eigen::Vector3d arriving = center - graph_.sphere(path[path.size() - 2]).center;
  const double length = graph_.PathLength(parent_sphere, sphere);
  for (int i : graph_.neighbors(sphere)) {
    if (graph_.PathLength(parent_sphere, i) > length &&
        arriving.dot(graph_.sphere(i).center - center) > 0) {
      return 1;
    }
  }
  return 0;
}

double PenaltyModel::PairPenalty(int j, int sphere, int parent_sphere, double cap) const {
  const SearchJoint& joint = tree_[j];
  const double length = graph_.PathLength(parent_sphere, sphere);
  if (!std::isfinite(length)) return kInfinite;
  const double stretch = length / (options_.template_scale * joint.length);
  if (stretch < 0.5) return kInfinite;
  const PenaltyWeights& weights = options_.weights;
  // `stretch` is measured against the reduced template, so that only chains under half of it are
  // forbidden. A chain at the body's own size has the stretch 1 / template_scale.
  const double natural = stretch * options_.template_scale;
  double cost = weights.length * (0.5 * Square(std::max(0.0, 1 / natural - 1)) +
                                  2 * Square(std::max(0.0, natural - 1.15)));
  cost += weights.direction *
          DirectionMismatch(graph_.sphere(sphere).center - graph_.sphere(parent_sphere).center,
                            joint.position - tree_[joint.parent].position);
  if (cost > cap) return cost;  // the rest takes a path
  const std::vector<int> path = graph_.Path(parent_sphere, sphere);
  if (joint.is_foot) {
    const Sphere& foot = graph_.sphere(sphere);
    const double height = (foot.center.y() - foot.radius - floor_height_) / body_size_;
    cost += weights.foot_height * Square(std::max(0.0, height) / 0.1);
  }
  if (sphere == parent_sphere) cost += weights.same_sphere;
  cost += weights.local_direction * LocalDirection(joint, path);
  if (joint.is_leaf) cost += weights.leaf * LeafPenalty(sphere, parent_sphere, path);
  return cost <= 1 ? cost : kInfinite;
}

PlacementContext PenaltyModel::MakeContext(int j, const std::vector<int>& spheres) const {
  PlacementContext context;
  context.joint = j;
  if (j == 0) return context;
  const SearchJoint& joint = tree_[j];
  context.parent_sphere = spheres[joint.parent];
  context.is_used.assign(graph_.size(), 0);
  std::vector<double> from_root(j, 0.0);  // along the embedded skeleton
  for (int k = 1; k < j; ++k) {
    const int parent_sphere = spheres[tree_[k].parent];
    from_root[k] = from_root[tree_[k].parent] + graph_.PathLength(parent_sphere, spheres[k]);
    for (int i : graph_.Path(parent_sphere, spheres[k])) context.is_used[i] = 1;
  }
  for (int k = 0; k < j; ++k) {
    if (k == joint.parent) continue;
    int a = k, b = joint.parent;  // indices grow from the root: climb from the larger one
    while (a != b) (a > b ? a : b) = tree_[a > b ? a : b].parent;
    context.others.push_back({spheres[k], from_root[joint.parent] + from_root[k] - 2 * from_root[a],
                              tree_[k].parent == joint.parent, joint.position - tree_[k].position});
  }
  if (joint.mirror >= 0 && joint.mirror < j) {
    const int m = joint.mirror;
    context.mirror_length = graph_.PathLength(spheres[tree_[m].parent], spheres[m]);
  }
  return context;
}

double PenaltyModel::ContextPenalty(const PlacementContext& context, int sphere) const {
  if (context.joint == 0) return 0;
  const PenaltyWeights& weights = options_.weights;
  const double length = graph_.PathLength(context.parent_sphere, sphere);
  const Eigen::Vector3d& center = graph_.sphere(sphere).center;
  double cost = 0;
  for (const PlacementContext::Other& other : context.others) {
    if (other.is_sibling) {
      cost += weights.direction *
              DirectionMismatch(center - graph_.sphere(other.sphere).center, other.template_offset);
    }
    const double along = other.length_to_parent + length;
    const double in_body = graph_.PathLength(other.sphere, sphere);
    if (along > 0) cost += weights.proximity * std::max(0.0, 1 - 2 * in_body / along);
  }
  if (length > 0) {
    double shared = 0;
    // Walks back along the shortest path. Each step belongs to the sphere that it arrives at.
    for (int i = sphere; i != context.parent_sphere;) {
      const int before = graph_.Predecessor(context.parent_sphere, i);
      if (context.is_used[i]) {
        shared += (graph_.sphere(i).center - graph_.sphere(before).center).norm();
      }
      i = before;
    }
    cost += weights.shared_path * shared / length;
    if (context.mirror_length > 0) {
      cost += weights.symmetry * 10 * Square(std::log(length / context.mirror_length));
    }
  }
  return cost <= 1 ? cost : kInfinite;
}

}  // namespace pleat
