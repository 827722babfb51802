// A signed distance field sampled on a regular grid (docs/method/rig.md#distance-field).
#pragma once

#include <Eigen/Core>
#include <vector>

#include "absl/status/statusor.h"
#include "pleat/base/progress.h"
#include "pleat/geometry/triangle_tree.h"
#include "pleat/geometry/winding_number.h"

namespace pleat {

struct DistanceFieldOptions {
  // Cells along the longest side of the bounds. 128 resolves a wrist of a standing person.
  int resolution = 128;
  int padding = 2;      // cells around the bounds
  int num_threads = 1;  // 0 = one per core
  // The surface has no boundary and is oriented consistently. The winding number is then the same
  // all along a way that meets no surface, and few nodes must be asked for it.
  bool is_closed = false;
};

// Distances are negative inside. They are exact at the nodes inside and within two cells of the
// surface outside; farther out they are clamped to two cells. Lengths are those of the input.
// Immutable once computed.
class DistanceField {
 public:
  // Computes the field over the bounds of the surface. Inside is where the winding number exceeds
  // one half. The error is kInvalidArgument when the surface has no extent or the resolution is not
  // in [8, 512], and kCancelled. The result does not depend on the number of threads.
  static absl::StatusOr<DistanceField> Compute(const TriangleTree& tree,
                                               const WindingNumber& winding_number,
                                               const DistanceFieldOptions& options = {},
                                               const Progress& progress = {});

  // Returns the distance at `point`: trilinear between nodes, two cells outside of the grid.
  double SignedDistance(const Eigen::Vector3d& point) const;

  // Returns the largest signed distance along the segment from `a` to `b`, sampled every half cell:
  // it is below -r when the whole segment lies at least r deep.
  double MaxAlongSegment(const Eigen::Vector3d& a, const Eigen::Vector3d& b) const;

  double spacing() const { return spacing_; }
  const Eigen::Vector3i& num_nodes() const { return num_nodes_; }
  int NodeIndex(int x, int y, int z) const { return x + num_nodes_.x() * (y + num_nodes_.y() * z); }
  Eigen::Vector3d NodePosition(int x, int y, int z) const {
    return origin_ + spacing_ * Eigen::Vector3d(x, y, z);
  }
  double node_distance(int node) const { return distances_[node]; }
  // Returns the unit vector from a node inside to the nearest surface point; zero at nodes outside.
  const Eigen::Vector3f& node_direction(int node) const { return directions_[node]; }

 private:
  class Sampler;

  Eigen::Vector3d origin_ = Eigen::Vector3d::Zero();
  double spacing_ = 1;
  Eigen::Vector3i num_nodes_ = Eigen::Vector3i::Zero();
  std::vector<float> distances_;
  std::vector<Eigen::Vector3f> directions_;
};

}  // namespace pleat
