#include "pleat/geometry/winding_number.h"

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

namespace pleat {
namespace {

// Returns the solid angle of a triangle seen from `point` (van Oosterom and Strackee 1983). atan2
// gives the right branch also where the denominator is negative.
double SolidAngle(const Eigen::Vector3d& point, const std::array<Eigen::Vector3d, 3>& corners) {
  const Eigen::Vector3d a = corners[0] - point, b = corners[1] - point, c = corners[2] - point;
  const double la = a.norm(), lb = b.norm(), lc = c.norm();
  const double numerator = a.dot(b.cross(c));
  const double denominator = la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb;
  return 2 * std::atan2(numerator, denominator);
}

}  // namespace

WindingNumber::WindingNumber(const TriangleTree& tree, double accuracy)
    : tree_(tree), dipoles_(tree.nodes().size()) {
  for (size_t n = 0; n < dipoles_.size(); ++n) {
    const TriangleTree::Node& node = tree.nodes()[n];
    Dipole& dipole = dipoles_[n];
    double area = 0;
    for (int k = node.first; k < node.first + node.count; ++k) {
      const auto& [a, b, c] = tree.corners(k);
      const Eigen::Vector3d area_vector = 0.5 * (b - a).cross(c - a);
      dipole.moment += area_vector;
      dipole.center += area_vector.norm() * (a + b + c) / 3;
      area += area_vector.norm();
    }
    dipole.center = area > 0 ? Eigen::Vector3d(dipole.center / area)
                             : Eigen::Vector3d(0.5 * (node.low + node.high));
    // The farthest corner of the node's box bounds every triangle below it.
    const Eigen::Vector3d reach =
        (node.high - dipole.center).cwiseMax(dipole.center - node.low) * accuracy;
    dipole.squared_reach = reach.squaredNorm();
  }
}

double WindingNumber::operator()(const Eigen::Vector3d& point) const {
  if (dipoles_.empty()) return 0;
  double solid_angle = 0;
  int stack[64];  // one per level; the tree is balanced
  int size = 0;
  stack[size++] = 0;
  while (size > 0) {
    const int n = stack[--size];
    const Dipole& dipole = dipoles_[n];
    const Eigen::Vector3d offset = dipole.center - point;
    const double squared_distance = offset.squaredNorm();
    if (squared_distance > dipole.squared_reach) {
      solid_angle += offset.dot(dipole.moment) / (squared_distance * std::sqrt(squared_distance));
      continue;
    }
    const TriangleTree::Node& node = tree_.nodes()[n];
    if (node.is_leaf()) {
      for (int k = node.first; k < node.first + node.count; ++k) {
        solid_angle += SolidAngle(point, tree_.corners(k));
      }
    } else {
      stack[size++] = node.right;
      stack[size++] = n + 1;
    }
  }
  return solid_angle / (4 * std::numbers::pi);
}

}  // namespace pleat
