#include "pleat/rigging/bone_visibility.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace pleat {
namespace {

constexpr double kTieRatio = 1.0001;

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
  if (inside.field == nullptr || std::abs(inside.field->SignedDistance(inner)) <= margin) {
    if (!inside.winding_number->IsInside(inner)) return false;
  }
  const Eigen::Vector3d direction = (vertex - inner) / length;
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
  std::vector<std::pair<double, int>> by_distance;
  std::vector<Eigen::Vector3d> nearest_points(skeleton.num_joints());
  for (int b = 1; b < skeleton.num_joints(); ++b) {
    nearest_points[b] =
        ClosestPointOnSegment(vertex, joints.col(skeleton.parent(b)), joints.col(b));
    by_distance.push_back({(nearest_points[b] - vertex).norm(), b});
  }
  std::sort(by_distance.begin(), by_distance.end());
  NearestBones nearest;
  // Visibility is expensive and distance is cheap, so bones are asked in the order of distance, and
  // the first that is seen ends the search but for ties.
  for (const auto& [distance, b] : by_distance) {
    if (!nearest.bones.empty() && distance > nearest.distance * kTieRatio) break;
    if (inside && !IsVisibleInside(*inside, nearest_points[b], vertex, tolerance)) continue;
    if (nearest.bones.empty()) nearest.distance = distance;
    nearest.bones.push_back(b);
  }
  return nearest;
}

}  // namespace pleat
