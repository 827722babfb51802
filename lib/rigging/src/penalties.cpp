#include "pleat/rigging/penalties.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "pleat/skeleton/human_template.h"

namespace pleat {
namespace {

constexpr double kInfinite = std::numeric_limits<double>::infinity();

double Square(double x) { return x * x; }

// Returns 0 for equal directions, .09 at 45 degrees (arms of a T-pose against the template's), 2 at
// a right angle, 10 for opposite ones, and that of a right angle when one has no length.
double DirectionMismatch(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  const double lengths = a.norm() * b.norm();
  const double turn = lengths > 1e-12 ? 1 - a.dot(b) / lengths : 1;
  return Square(turn) + 2 * Square(std::max(0.0, turn - 0.3));
}

}  // namespace

PenaltyModel::PenaltyModel(const SphereGraph& graph, const SearchTree& tree, double floor_height,
                           double body_size, const PenaltyOptions& options,
                           std::shared_ptr<const SearchChains> chains)
    : graph_(graph),
      tree_(tree),
      floor_height_(floor_height),
      body_size_(body_size),
      options_(options),
      chains_(std::move(chains)) {
  if (chains_ == nullptr) {
    chains_ = std::make_shared<const SearchChains>(graph, tree, options.max_deep_candidates,
                                                   options.placed);
  }
}

double PenaltyModel::LocalDirection(int j, size_t c, size_t p) const {
  const SearchJoint& joint = tree_[j];
  const auto points = chains_->points(j, c, p);
  Eigen::Vector3d start = graph_.sphere(candidates(joint.parent)[p]).center;
  double mismatch = 0;
  for (size_t k = 0; k < joint.chain.size(); ++k) {
    const Eigen::Vector3d end = points.col(static_cast<Eigen::Index>(k));
    double bone = DirectionMismatch(end - start, joint.directions.col(k));
    if (joint.chain[k] == kLeftHand || joint.chain[k] == kRightHand) {
      bone = std::min(bone, options_.most_forearm_mismatch);
    }
    mismatch += joint.bone_lengths[k] / joint.length * bone;
    start = end;
  }
  return mismatch;
}

double PenaltyModel::LeafPenalty(int sphere, int parent_sphere) const {
  const int before = graph_.Predecessor(parent_sphere, sphere);
  if (before < 0) return 1;
  const Eigen::Vector3d& center = graph_.sphere(sphere).center;
  const Eigen::Vector3d arriving = center - graph_.sphere(before).center;
  const double length = graph_.PathLength(parent_sphere, sphere);
  for (int i : graph_.neighbors(sphere)) {
    if (graph_.PathLength(parent_sphere, i) > length &&
        arriving.dot(graph_.sphere(i).center - center) > 0) {
      return 1;
    }
  }
  return 0;
}

double PenaltyModel::PairPenalty(int j, size_t c, size_t p, double cap) const {
  const SearchJoint& joint = tree_[j];
  const int sphere = candidates(j)[c], parent_sphere = candidates(joint.parent)[p];
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
  if (joint.is_foot) {
    const Sphere& foot = graph_.sphere(sphere);
    const double height = (foot.center.y() - foot.radius - floor_height_) / body_size_;
    cost += weights.foot_height * Square(std::max(0.0, height) / 0.1);
  }
  if (sphere == parent_sphere) cost += weights.same_sphere;
  if (cost > cap) return cost;
  cost += weights.local_direction * LocalDirection(j, c, p);
  if (joint.is_leaf) cost += weights.leaf * LeafPenalty(sphere, parent_sphere);
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
