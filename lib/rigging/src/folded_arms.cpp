#include "folded_arms.h"

#include <algorithm>
#include <limits>
#include <queue>
#include <utility>

#include "pleat/skeleton/human_template.h"

namespace pleat {
namespace {

// The share of a leg below which an arm counts as short. Arms to the wrist measure .56 to .64,
// those of people by Drillis and Contini .68.
constexpr double kArmShare = .5;
// The same as a share of the trunk, from the hips of the legs to the shoulders: 1.1 to 1.3 in
// people, .65 up to the elbow.
constexpr double kArmPerTrunk = .8;
constexpr double kShortArm = .05;  // of the shortfall: such arms end early
// Radii of a forearm's spheres, in that of the arm at the elbow: what is thicker belongs to the
// trunk.
constexpr double kThickest = 1.5;
// Lengths in those of the upper arm: to the tip of the hand at most, to the wrist, and what is too
// short to be a forearm.
constexpr double kLongest = 1.4, kToWrist = .97, kShortest = .5;
constexpr double kStraight = 1.1;  // a way, in the distance of its ends

// Returns the length of the arm or leg of three joints that begins in `first`.
double LimbLength(const Eigen::Matrix3Xd& joints, int first) {
  return (joints.col(first + 1) - joints.col(first)).norm() +
         (joints.col(first + 2) - joints.col(first + 1)).norm();
}

double LegLength(const Eigen::Matrix3Xd& joints) {
  return .5 * (LimbLength(joints, kLeftUpperLeg) + LimbLength(joints, kRightUpperLeg));
}

}  // namespace

double ArmShortfall(const Eigen::Matrix3Xd& joints, int shoulder) {
  const double leg = LegLength(joints);
  return leg > 0 ? std::max(0.0, kArmShare - LimbLength(joints, shoulder) / leg) : 0.0;
}

bool EndsEarly(const Eigen::Matrix3Xd& joints, int shoulder) {
  const double trunk = .5 * (joints.col(kLeftUpperArm) + joints.col(kRightUpperArm) -
                             joints.col(kLeftUpperLeg) - joints.col(kRightUpperLeg))
                                .norm();
  return ArmShortfall(joints, shoulder) > kShortArm ||
         LimbLength(joints, shoulder) < kArmPerTrunk * trunk;
}

std::optional<FoldedArm> FollowForearm(const SphereGraph& graph, int elbow, double radius,
                                       const std::vector<char>& is_taken,
                                       const Eigen::Vector3d& shoulder) {
  const Sphere& start = graph.sphere(elbow);
  const double thickest = kThickest * radius;
  const double upper_arm = (start.center - shoulder).norm();
  // Dijkstra among thin spheres; ties go to the lower index.
  std::vector<double> lengths(graph.size(), std::numeric_limits<double>::infinity());
  using Entry = std::pair<double, int>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<Entry>> queue;
  lengths[elbow] = 0;
  queue.push({0, elbow});
  double farthest = kShortest * upper_arm;
  std::optional<Eigen::Vector3d> tip;
  while (!queue.empty()) {
    const auto [length, i] = queue.top();
    queue.pop();
    if (length > lengths[i]) continue;
    const double straight = (graph.sphere(i).center - start.center).norm();
    if (straight > farthest && length <= kStraight * straight) {
      farthest = straight;
      tip = graph.sphere(i).center;
    }
    for (const int j : graph.neighbors(i)) {
      const Sphere& next = graph.sphere(j);
      const double through = length + (next.center - graph.sphere(i).center).norm();
      if (is_taken[j] != 0 || next.radius > thickest || through > kLongest * upper_arm ||
          !(through < lengths[j])) {
        continue;
      }
      lengths[j] = through;
      queue.push({through, j});
    }
  }
  if (!tip) return std::nullopt;
  const double to_wrist = std::min(kToWrist * upper_arm / farthest, 1.0);
  return FoldedArm{start.center, start.center + to_wrist * (*tip - start.center)};
}

void UnfoldArms(const SphereGraph& graph, const SearchTree& tree, const std::vector<int>& spheres,
                const std::vector<PlacedJoint>& placed, Eigen::Matrix3Xd* joints) {
  std::vector<char> is_taken(graph.size(), 0);
  for (size_t k = 1; k < spheres.size(); ++k) {
    for (const int i : graph.Path(spheres[tree[k].parent], spheres[k])) is_taken[i] = 1;
  }
  for (size_t k = 1; k < spheres.size(); ++k) {
    const int hand = tree[k].human_joint, elbow = hand - 1, shoulder = hand - 2;
    if (hand != kLeftHand && hand != kRightHand) continue;
    if (!EndsEarly(*joints, shoulder)) continue;
    const bool is_placed = std::ranges::any_of(placed, [&](const PlacedJoint& known) {
      return known.joint == elbow || known.joint == hand;
    });
    if (is_placed) continue;
    // The last sphere may be a small one beside the others.
    const std::vector<int> path = graph.Path(spheres[tree[k].parent], spheres[k]);
    double radius = 0;
    for (size_t i = path.size() < 3 ? 0 : path.size() - 3; i < path.size(); ++i) {
      radius = std::max(radius, graph.sphere(path[i]).radius);
    }
    const std::optional<FoldedArm> arm =
        FollowForearm(graph, spheres[k], radius, is_taken, joints->col(shoulder));
    if (!arm) continue;
    joints->col(elbow) = arm->elbow;
    joints->col(hand) = arm->hand;
  }
}

}  // namespace pleat
