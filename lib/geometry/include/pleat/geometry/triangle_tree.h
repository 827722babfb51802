// A bounding volume hierarchy over triangles with closest-point queries. Building costs O(F log F).
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <limits>
#include <vector>

namespace pleat {

struct SurfacePoint {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();
  double squared_distance = std::numeric_limits<double>::infinity();
  int triangle = -1;  // index in the input; -1 when nothing lies within the search radius
};

// Returns the point of the triangle (a, b, c) nearest to `point` (Ericson, Real-Time Collision
// Detection, 2005, section 5.1.5).
Eigen::Vector3d ClosestPointOnTriangle(const Eigen::Vector3d& point,
                                       const std::array<Eigen::Vector3d, 3>& corners);

// Immutable and safe to query from many threads. It holds copies of the triangles.
class TriangleTree {
 public:
  struct Node {
    Eigen::Vector3d low, high;  // bounds
    int32_t first = 0;          // first triangle in tree order
    int32_t count = 0;          // triangles below this node
    int32_t right = -1;         // right child; the left one is the next node; -1 = leaf
    bool is_leaf() const { return right < 0; }
  };

  // positions: 3 x V; triangles: 3 x F, indices valid, F may be 0.
  TriangleTree(const Eigen::Ref<const Eigen::Matrix3Xd>& positions,
               const Eigen::Ref<const Eigen::Matrix3Xi>& triangles);

  // Returns the nearest surface point within `max_squared_distance` of `point` (exclusive). When
  // there is none, the triangle is -1 and the squared distance is the given one.
  SurfacePoint ClosestPoint(
      const Eigen::Vector3d& point,
      double max_squared_distance = std::numeric_limits<double>::infinity()) const;

  int num_triangles() const { return static_cast<int>(corners_.size()); }
  const std::vector<Node>& nodes() const { return nodes_; }  // depth first, root first
  // The corners of the triangle at position `k` of the tree order.
  const std::array<Eigen::Vector3d, 3>& corners(int k) const { return corners_[k]; }

 private:
  int32_t Build(std::vector<Eigen::Vector3d>& centers, int32_t first, int32_t count);

  std::vector<Node> nodes_;
  std::vector<int32_t> order_;
  std::vector<std::array<Eigen::Vector3d, 3>> corners_;
};

}  // namespace pleat
