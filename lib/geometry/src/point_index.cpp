#include "pleat/geometry/point_index.h"

#include <limits>
#include <nanoflann.hpp>

namespace pleat {

class PointIndex::Tree {
 public:
  Tree(const Eigen::Matrix3Xd& points, int leaf_size)
      : points_(points),
        index_(3, *this,
               nanoflann::KDTreeSingleIndexAdaptorParams(static_cast<size_t>(leaf_size))) {}
  Tree(const Tree&) = delete;
  Tree& operator=(const Tree&) = delete;

  const auto& index() const { return index_; }

  // The interface that nanoflann asks for.
  size_t kdtree_get_point_count() const { return static_cast<size_t>(points_.cols()); }
  double kdtree_get_pt(size_t point, size_t axis) const {
    return points_(static_cast<Eigen::Index>(axis), static_cast<Eigen::Index>(point));
  }
  template <typename Box>
  bool kdtree_get_bbox(Box&) const {
    return false;
  }

 private:
  Eigen::Matrix3Xd points_;
  nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<double, Tree>, Tree, 3, size_t>
      index_;
};

PointIndex::PointIndex(const Eigen::Matrix3Xd& points, int leaf_size)
    : tree_(std::make_unique<const Tree>(points, leaf_size)) {}
PointIndex::~PointIndex() = default;
PointIndex::PointIndex(PointIndex&&) noexcept = default;
PointIndex& PointIndex::operator=(PointIndex&&) noexcept = default;

int PointIndex::Nearest(const Eigen::Vector3d& query, double* squared_distance) const {
  size_t nearest = 0;
  double squared = 0;
  const bool found = tree_->index().knnSearch(query.data(), 1, &nearest, &squared) > 0;
  if (squared_distance) {
    *squared_distance = found ? squared : std::numeric_limits<double>::infinity();
  }
  return found ? static_cast<int>(nearest) : -1;
}

std::vector<std::pair<int, double>> PointIndex::NearestFew(const Eigen::Vector3d& query,
                                                           int count) const {
  std::vector<size_t> indices(static_cast<size_t>(count));
  std::vector<double> squared(static_cast<size_t>(count));
  const size_t found =
      tree_->index().knnSearch(query.data(), indices.size(), indices.data(), squared.data());
  std::vector<std::pair<int, double>> result(found);
  for (size_t i = 0; i < found; ++i) result[i] = {static_cast<int>(indices[i]), squared[i]};
  return result;
}

std::vector<std::pair<size_t, double>> PointIndex::Within(const Eigen::Vector3d& query,
                                                          double radius) const {
  std::vector<std::pair<size_t, double>> result;
  tree_->index().radiusSearch(query.data(), radius * radius, result, nanoflann::SearchParams());
  return result;
}

}  // namespace pleat
