#include "pleat/geometry/triangle_tree.h"

#include <algorithm>
#include <numeric>

namespace pleat {
namespace {

constexpr int kMaxLeafTriangles = 4;

double SquaredDistanceToBox(const Eigen::Vector3d& point, const TriangleTree::Node& node) {
  return (node.low - point).cwiseMax(point - node.high).cwiseMax(0.0).squaredNorm();
}

// A triangle whose height is less than 5e-6 of its longest edge is a line or a point. Rounding
// moves the point inside of a triangle by 1e-16 / (height / edge)^2 of the edge, its edges are at
// most the height away: there the two are equal.
constexpr double kSquaredHeightOfLine = 2.5e-11;

Eigen::Vector3d ClosestPointOnSegment(const Eigen::Vector3d& point, const Eigen::Vector3d& start,
                                      const Eigen::Vector3d& end) {
  const Eigen::Vector3d along = end - start;
  const double squared = along.squaredNorm();
  const double share = squared > 0 ? std::clamp(along.dot(point - start) / squared, 0.0, 1.0) : 0;
  return start + share * along;
}

Eigen::Vector3d ClosestPointOnEdges(const Eigen::Vector3d& point,
                                    const std::array<Eigen::Vector3d, 3>& corners) {
  Eigen::Vector3d nearest = ClosestPointOnSegment(point, corners[2], corners[0]);
  for (int k = 0; k < 2; ++k) {
    const Eigen::Vector3d other = ClosestPointOnSegment(point, corners[k], corners[k + 1]);
    if ((other - point).squaredNorm() < (nearest - point).squaredNorm()) nearest = other;
  }
  return nearest;
}

}  // namespace

Eigen::Vector3d ClosestPointOnTriangle(const Eigen::Vector3d& point,
                                       const std::array<Eigen::Vector3d, 3>& corners) {
  const auto& [a, b, c] = corners;
  const Eigen::Vector3d ab = b - a, ac = c - a, ap = point - a;
  const double d1 = ab.dot(ap), d2 = ac.dot(ap);
  if (d1 <= 0 && d2 <= 0) return a;
  const Eigen::Vector3d bp = point - b;
  const double d3 = ab.dot(bp), d4 = ac.dot(bp);
  if (d3 >= 0 && d4 <= d3) return b;
  const double vc = d1 * d4 - d3 * d2;
  // Not an edge when a and b are one point: c decides then.
  if (vc <= 0 && d1 >= 0 && d3 <= 0 && d1 > d3) return a + d1 / (d1 - d3) * ab;
  const Eigen::Vector3d cp = point - c;
  const double d5 = ab.dot(cp), d6 = ac.dot(cp);
  if (d6 >= 0 && d5 <= d6) return c;
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return a + (d2 > d6 ? d2 / (d2 - d6) : 0.0) * ac;
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 >= d3 && d5 >= d6) {
    const double along = (d4 - d3) + (d5 - d6);
    return b + (along > 0 ? (d4 - d3) / along : 0.0) * (c - b);
  }
  const double squared_normal = va + vb + vc;  // |ab x ac|^2 = (longest edge * height)^2
  const double longest = std::max({d1 - d3, d2 - d6, (d4 - d3) + (d5 - d6)});  // squared
  if (!(squared_normal > kSquaredHeightOfLine * longest * longest)) {
    return ClosestPointOnEdges(point, corners);
  }
  const double scale = 1 / squared_normal;
  return a + vb * scale * ab + vc * scale * ac;
}

TriangleTree::TriangleTree(const Eigen::Ref<const Eigen::Matrix3Xd>& positions,
                           const Eigen::Ref<const Eigen::Matrix3Xi>& triangles) {
  const int num_triangles = static_cast<int>(triangles.cols());
  if (num_triangles == 0) return;
  order_.resize(num_triangles);
  std::iota(order_.begin(), order_.end(), 0);
  corners_.resize(num_triangles);
  std::vector<Eigen::Vector3d> centers(num_triangles);
  for (int f = 0; f < num_triangles; ++f) {
    for (int k = 0; k < 3; ++k) corners_[f][k] = positions.col(triangles(k, f));
    centers[f] = (corners_[f][0] + corners_[f][1] + corners_[f][2]) / 3;
  }
  nodes_.reserve(num_triangles);
  Build(centers, 0, num_triangles);
  std::vector<std::array<Eigen::Vector3d, 3>> sorted(num_triangles);
  for (int k = 0; k < num_triangles; ++k) sorted[k] = corners_[order_[k]];
  corners_ = std::move(sorted);
}

// Splits at the median of the centers along their longest extent. Halves of equal count bound the
// depth by log2 of the count, which the fixed stacks of the queries rely on.
int32_t TriangleTree::Build(std::vector<Eigen::Vector3d>& centers, int32_t first, int32_t count) {
  const int32_t index = static_cast<int32_t>(nodes_.size());
  nodes_.emplace_back();
  Eigen::Vector3d low = Eigen::Vector3d::Constant(std::numeric_limits<double>::infinity());
  Eigen::Vector3d high = -low, center_low = low, center_high = -low;
  for (int32_t k = first; k < first + count; ++k) {
    for (const Eigen::Vector3d& corner : corners_[order_[k]]) {
      low = low.cwiseMin(corner);
      high = high.cwiseMax(corner);
    }
    center_low = center_low.cwiseMin(centers[order_[k]]);
    center_high = center_high.cwiseMax(centers[order_[k]]);
  }
  nodes_[index].low = low;
  nodes_[index].high = high;
  nodes_[index].first = first;
  nodes_[index].count = count;
  if (count <= kMaxLeafTriangles) return index;

  int axis = 0;
  (center_high - center_low).maxCoeff(&axis);
  const int32_t half = count / 2;
  std::nth_element(order_.begin() + first, order_.begin() + first + half,
                   order_.begin() + first + count, [&](int32_t a, int32_t b) {
                     const double ca = centers[a][axis], cb = centers[b][axis];
                     return ca != cb ? ca < cb : a < b;
                   });
  Build(centers, first, half);
  const int32_t right = Build(centers, first + half, count - half);
  nodes_[index].right = right;
  return index;
}

SurfacePoint TriangleTree::ClosestPoint(const Eigen::Vector3d& point,
                                        double max_squared_distance) const {
  SurfacePoint best;
  best.squared_distance = max_squared_distance;
  if (nodes_.empty()) return best;
  struct Entry {
    int32_t node;
    double squared_distance;
  };
  Entry stack[64];  // one per level; the tree is balanced
  int size = 0;
  stack[size++] = {0, SquaredDistanceToBox(point, nodes_[0])};
  while (size > 0) {
    const Entry entry = stack[--size];
    if (entry.squared_distance >= best.squared_distance) continue;
    const Node& node = nodes_[entry.node];
    if (!node.is_leaf()) {
      Entry near{entry.node + 1, SquaredDistanceToBox(point, nodes_[entry.node + 1])};
      Entry far{node.right, SquaredDistanceToBox(point, nodes_[node.right])};
      // The nearer child is looked at first: what is found there prunes the other one.
      if (far.squared_distance < near.squared_distance) std::swap(near, far);
      if (far.squared_distance < best.squared_distance) stack[size++] = far;
      if (near.squared_distance < best.squared_distance) stack[size++] = near;
      continue;
    }
    for (int32_t k = node.first; k < node.first + node.count; ++k) {
      const Eigen::Vector3d candidate = ClosestPointOnTriangle(point, corners_[k]);
      const double squared_distance = (candidate - point).squaredNorm();
      if (squared_distance < best.squared_distance) {
        best = {candidate, squared_distance, order_[k]};
      }
    }
  }
  return best;
}

}  // namespace pleat
