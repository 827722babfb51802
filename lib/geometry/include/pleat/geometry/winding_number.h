// Generalized winding numbers: inside and outside for open, overlapping and slightly broken meshes.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "pleat/geometry/triangle_tree.h"

namespace pleat {

// The generalized winding number of a triangle soup (Jacobson, Kavan, Sorkine-Hornung 2013),
// approximated far from clusters of triangles by one dipole per cluster (Barill, Dickson, Schmidt,
// Levin, Jacobson 2018, first order). It is one inside a closed, outward oriented surface, zero
// outside, and smooth across holes. See docs/method/rig.md#winding-number.
class WindingNumber {
 public:
  // `tree` must outlive this object. A cluster is approximated when the point is farther from its
  // center than `accuracy` times its radius; 2 keeps the error below about 0.05.
  explicit WindingNumber(const TriangleTree& tree, double accuracy = 2);

  double operator()(const Eigen::Vector3d& point) const;
  bool IsInside(const Eigen::Vector3d& point) const { return (*this)(point) > 0.5; }

 private:
  struct Dipole {
    Eigen::Vector3d center = Eigen::Vector3d::Zero();  // area weighted
    Eigen::Vector3d moment = Eigen::Vector3d::Zero();  // sum of area vectors, m^2
    double squared_reach = 0;                          // (accuracy * radius)^2
  };
  const TriangleTree& tree_;
  std::vector<Dipole> dipoles_;  // per node of the tree
};

}  // namespace pleat
