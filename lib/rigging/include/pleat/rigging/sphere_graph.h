// Step 5 of the embedding: the graph of packed spheres and its shortest paths
// (docs/method/rig.md#sphere-graph).
#pragma once

#include <Eigen/Core>
#include <utility>
#include <vector>

#include "pleat/geometry/distance_field.h"
#include "pleat/rigging/sphere_packing.h"

namespace pleat {

// A graph with spheres as nodes and edges where one can walk inside the body from center to center.
// Immutable.
class SphereGraph {
 public:
  SphereGraph() = default;  // has no spheres
  // Joins overlapping spheres, and others when the ball over the segment between their centers
  // holds no third center (Gabriel) and the segment stays at least half of the smaller radius deep
  // (Baran and Popovic 2007, section 3.1). All shortest paths are computed here: O(N E log N) time,
  // O(N^2) memory.
  SphereGraph(std::vector<Sphere> spheres, const DistanceField& field);
  // Takes the given edges (pairs of indices) instead.
  SphereGraph(std::vector<Sphere> spheres, const std::vector<std::pair<int, int>>& edges);

  // Returns the graph of those spheres that hang together and hold the most volume, in their order.
  SphereGraph LargestGroup() const;
  // Returns the same graph, turned about the origin.
  SphereGraph Turned(const Eigen::Matrix3d& turn) const;

  int size() const { return static_cast<int>(spheres_.size()); }
  const Sphere& sphere(int i) const { return spheres_[i]; }
  const std::vector<Sphere>& spheres() const { return spheres_; }
  const std::vector<int>& neighbors(int i) const { return neighbors_[i]; }

  // Returns the length of the shortest path, infinite when there is none.
  double PathLength(int from, int to) const { return distances_(to, from); }
  // Returns the node before `to` on the shortest path, -1 at its start or when there is none.
  int Predecessor(int from, int to) const { return predecessors_(to, from); }
  // Returns the nodes of the shortest path, both ends included; empty when there is none.
  std::vector<int> Path(int from, int to) const;

 private:
  void ComputeShortestPaths();

  std::vector<Sphere> spheres_;
  std::vector<std::vector<int>> neighbors_;
  Eigen::MatrixXd distances_;     // N x N, column = start
  Eigen::MatrixXi predecessors_;  // N x N, column = start; -1 = none
};

}  // namespace pleat
