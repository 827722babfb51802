// Finds the bones that a surface vertex is near to and sees through the body.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "pleat/geometry/distance_field.h"
#include "pleat/geometry/triangle_tree.h"
#include "pleat/geometry/winding_number.h"
#include "pleat/skeleton/skeleton.h"

namespace pleat {

// Returns the point of the segment from a to b nearest to `point`.
Eigen::Vector3d ClosestPointOnSegment(const Eigen::Vector3d& point, const Eigen::Vector3d& a,
                                      const Eigen::Vector3d& b);

// Tells inside from outside. A distance field, where there is one, answers far from the surface
// without a search of the tree; the result is the same. What it points to must outlive it.
struct InsideTest {
  const TriangleTree* tree = nullptr;
  const WindingNumber* winding_number = nullptr;
  const DistanceField* field = nullptr;  // may be null
};

// Returns true when the way from `inner` to the surface vertex `vertex` stays inside the body. The
// last stretch of twice the length `tolerance`, next to the vertex, is not looked at: there the way
// leaves the body anyway.
bool IsVisibleInside(const InsideTest& inside, const Eigen::Vector3d& inner,
                     const Eigen::Vector3d& vertex, double tolerance);

// The bones at the smallest distance from a vertex; more than one at a tie.
struct NearestBones {
  std::vector<int> bones;  // empty when the vertex sees none
  double distance = 0;
};

// Returns the nearest bones that `vertex` sees. joints: 3 x J. With `inside` null every bone is
// visible. Bones within a factor 1.0001 of the smallest distance count as a tie.
NearestBones FindNearestBones(const Skeleton& skeleton, const Eigen::Matrix3Xd& joints,
                              const Eigen::Vector3d& vertex, const InsideTest* inside = nullptr,
                              double tolerance = 0);

}  // namespace pleat
