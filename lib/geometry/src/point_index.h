// Nearest neighbors among points of three-space (nanoflann's k-d tree).
#pragma once

#include <Eigen/Core>
#include <nanoflann.hpp>
#include <utility>
#include <vector>

namespace pleat {

// Keeps its own copy of the points. The tree refers to this object, so it can be neither copied nor
// moved. Queries are const and may come from several threads.
class PointIndex {
 public:
  explicit PointIndex(Eigen::Matrix3Xd points)
      : points_(std::move(points)), tree_(3, *this, nanoflann::KDTreeSingleIndexAdaptorParams(8)) {}
  PointIndex(const PointIndex&) = delete;
  PointIndex& operator=(const PointIndex&) = delete;

  // Returns the `count` nearest points, nearest first, as (index, squared distance); fewer when
  // there are fewer points.
  std::vector<std::pair<int, double>> Nearest(const Eigen::Vector3d& query, int count) const {
    std::vector<size_t> indices(count);
    std::vector<double> squared(count);
    const size_t found = tree_.knnSearch(query.data(), count, indices.data(), squared.data());
    std::vector<std::pair<int, double>> result(found);
    for (size_t i = 0; i < found; ++i) result[i] = {static_cast<int>(indices[i]), squared[i]};
    return result;
  }

  // Returns all points nearer than `radius` as (index, squared distance), in no particular order.
  std::vector<std::pair<size_t, double>> Within(const Eigen::Vector3d& query, double radius) const {
    std::vector<std::pair<size_t, double>> result;
    tree_.radiusSearch(query.data(), radius * radius, result, nanoflann::SearchParams());
    return result;
  }

  // The interface that nanoflann asks for.
  size_t kdtree_get_point_count() const { return static_cast<size_t>(points_.cols()); }
  double kdtree_get_pt(size_t index, size_t axis) const { return points_(axis, index); }
  template <typename Box>
  bool kdtree_get_bbox(Box&) const {
    return false;
  }

 private:
  Eigen::Matrix3Xd points_;
  nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<double, PointIndex>, PointIndex,
                                      3, size_t>
      tree_;
};

}  // namespace pleat
