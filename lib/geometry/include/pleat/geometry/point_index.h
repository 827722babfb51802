// Nearest neighbors among points of three-space (nanoflann's k-d tree).
#pragma once

#include <Eigen/Core>
#include <memory>
#include <utility>
#include <vector>

namespace pleat {

// Keeps its own copy of the points. Queries may run at the same time.
class PointIndex {
 public:
  // points: 3 x N. Points of one leaf of the tree are compared one by one; which of two equally
  // near points is found depends on leaf_size.
  explicit PointIndex(const Eigen::Matrix3Xd& points, int leaf_size = 8);
  ~PointIndex();
  PointIndex(PointIndex&&) noexcept;
  PointIndex& operator=(PointIndex&&) noexcept;

  // Index of the nearest point, -1 when there are no points. No allocation. `squared_distance` may
  // be null.
  int Nearest(const Eigen::Vector3d& query, double* squared_distance) const;

  // The `count` nearest points, nearest first: (index, squared distance). Fewer when there are
  // fewer points.
  std::vector<std::pair<int, double>> NearestFew(const Eigen::Vector3d& query, int count) const;

  // All points nearer than `radius`, in no particular order: (index, squared distance).
  std::vector<std::pair<size_t, double>> Within(const Eigen::Vector3d& query, double radius) const;

 private:
  class Tree;
  std::unique_ptr<const Tree> tree_;
};

}  // namespace pleat
