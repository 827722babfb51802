#include "pleat/rigging/bone_visibility.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

namespace pleat {
namespace {

constexpr double kTieRatio = 1.0001;

// The point of a bone that is nearest to a vertex.
struct Candidate {
  double distance;
  int bone;
  Eigen::Vector3d point;
};

// Returns true when some point of the way lies clearly outside by the field alone. Looked at from
// end to end before any exact test, it spares most ways through the air those beside thin walls.
bool LeavesField(const DistanceField& field, const Eigen::Vector3d& inner,
                 const Eigen::Vector3d& direction, double length, double margin) {
  for (double walked = 0; walked < length;) {
    const double distance = field.SignedDistance(inner + walked * direction);
    if (distance > margin) return true;
    walked += std::max(.5 * field.spacing(), -distance - margin);
  }
  return false;
}

}  // namespace

Eigen::Vector3d ClosestPointOnSegment(const Eigen::Vector3d& point, const Eigen::Vector3d& a,
                                      const Eigen::Vector3d& b) {
  const Eigen::Vector3d bone = b - a;
  const double squared_length = bone.squaredNorm();
  if (!(squared_length > 0)) return a;
  return a + std::clamp(bone.dot(point - a) / squared_length, 0.0, 1.0) * bone;
}

bool IsVisibleInside(const InsideTest& inside, const Eigen::Vector3d& inner,
                     const Eigen::Vector3d& vertex, double tolerance) {
  const double length = (vertex - inner).norm();
  if (length <= 2 * tolerance) return true;
  // Between its nodes the field is off by less than one spacing.
  const double margin = inside.field != nullptr ? inside.field->spacing() : 0;
  const Eigen::Vector3d direction = (vertex - inner) / length;
  if (inside.field != nullptr &&
      LeavesField(*inside.field, inner, direction, length - 2 * tolerance, margin)) {
    return false;
  }
  if (inside.field == nullptr || std::abs(inside.field->SignedDistance(inner)) <= margin) {
    if (!inside.winding_number->IsInside(inner)) return false;
  }
  // A ball that reaches no surface is all inside or all outside: walk from ball to ball, and ask
  // for the side again only after a step that may have crossed a surface.
  for (double walked = 0; walked < length - 2 * tolerance;) {
    const Eigen::Vector3d point = inner + walked * direction;
    if (inside.field != nullptr) {
      const double distance = inside.field->SignedDistance(point);
      if (distance > margin) return false;
      if (distance < -margin - tolerance) {
        walked += -distance - margin;
        continue;
      }
    }
    const double clearance = std::sqrt(inside.tree->ClosestPoint(point).squared_distance);
    walked += std::max(clearance, tolerance);
    if (clearance >= tolerance) continue;
    if (walked < length - 2 * tolerance &&
        !inside.winding_number->IsInside(inner + walked * direction)) {
      return false;
    }
  }
  return true;
}

NearestBones FindNearestBones(const Skeleton& skeleton, const Eigen::Matrix3Xd& joints,
                              const Eigen::Vector3d& vertex, const InsideTest* inside,
                              double tolerance) {
  std::vector<Candidate> candidates;
  candidates.reserve(skeleton.num_joints());
  double least = std::numeric_limits<double>::infinity();
  for (int b = 1; b < skeleton.num_joints(); ++b) {
    const Eigen::Vector3d point =
        ClosestPointOnSegment(vertex, joints.col(skeleton.parent(b)), joints.col(b));
    candidates.push_back({(point - vertex).norm(), b, point});
    least = std::min(least, candidates.back().distance);
  }
  // Without the test all that is asked for are the nearest ones: the others need no order.
  if (inside == nullptr) {
    std::erase_if(candidates, [least](const Candidate& candidate) {
      return candidate.distance > least * kTieRatio;
    });
  }
  std::ranges::sort(candidates, {}, [](const Candidate& candidate) {
    return std::pair(candidate.distance, candidate.bone);
  });
  NearestBones nearest;
  // Visibility is expensive and distance is cheap, so bones are asked in the order of distance, and
  // the first that is seen ends the search but for ties.
  for (const Candidate& candidate : candidates) {
    if (!nearest.bones.empty() && candidate.distance > nearest.distance * kTieRatio) break;
    if (inside && !IsVisibleInside(*inside, candidate.point, vertex, tolerance)) continue;
    if (nearest.bones.empty()) nearest.distance = candidate.distance;
    nearest.bones.push_back(candidate.bone);
  }
  return nearest;
}

}  // namespace pleat
