#include "pleat/geometry/distance_field.h"

#include <algorithm>
#include <cmath>

#include "absl/strings/str_cat.h"
#include "pleat/base/parallel.h"
#include "pleat/base/status.h"

namespace pleat {
namespace {

constexpr int kMinResolution = 8, kMaxResolution = 512;
constexpr double kBandCells = 2;

}  // namespace

absl::StatusOr<DistanceField> DistanceField::Compute(const TriangleTree& tree,
                                                     const WindingNumber& winding_number,
                                                     const DistanceFieldOptions& options,
                                                     const Progress& progress) {
  if (options.resolution < kMinResolution || options.resolution > kMaxResolution) {
    return absl::InvalidArgumentError(absl::StrCat("distance field resolution is ",
                                                   options.resolution, ", must be ", kMinResolution,
                                                   " to ", kMaxResolution));
  }
  if (tree.num_triangles() == 0) {
    return absl::InvalidArgumentError("a distance field needs at least one triangle");
  }
  const TriangleTree::Node& root = tree.nodes()[0];
  const double longest = (root.high - root.low).maxCoeff();
  if (!(longest > 0) || !std::isfinite(longest)) {
    return absl::InvalidArgumentError(
        absl::StrCat("the surface has no extent (longest side ", longest, ")"));
  }
  DistanceField field;
  field.spacing_ = longest / options.resolution;
  field.origin_ = root.low - Eigen::Vector3d::Constant(options.padding * field.spacing_);
  for (int k = 0; k < 3; ++k) {
    field.num_nodes_[k] =
        static_cast<int>(std::ceil((root.high[k] - root.low[k]) / field.spacing_)) + 1 +
        2 * options.padding;
  }
  const size_t num_nodes = static_cast<size_t>(field.num_nodes_.x()) * field.num_nodes_.y() *
                           static_cast<size_t>(field.num_nodes_.z());
  field.distances_.resize(num_nodes);
  field.directions_.assign(num_nodes, Eigen::Vector3f::Zero());
  ParallelFor(field.num_nodes_.z(), options.num_threads, [&](int z) {
    for (int y = 0; y < field.num_nodes_.y() && !progress.cancelled(); ++y) {
      field.ComputeRow(tree, winding_number, y, z);
    }
  });
  PLEAT_RETURN_IF_ERROR(progress.Report(1));
  return field;
}

void DistanceField::ComputeRow(const TriangleTree& tree, const WindingNumber& winding_number, int y,
                               int z) {
  const double band = kBandCells * spacing_;
  // The distance changes by at most one spacing from node to node, which bounds the next search.
  double reach = std::numeric_limits<double>::infinity();
  for (int x = 0; x < num_nodes_.x(); ++x) {
    const Eigen::Vector3d point = NodePosition(x, y, z);
    const int node = NodeIndex(x, y, z);
    const bool inside = winding_number.IsInside(point);
    const double radius = inside ? reach : band;
    const SurfacePoint nearest = tree.ClosestPoint(point, radius * radius);
    const double distance = nearest.triangle < 0 ? band : std::sqrt(nearest.squared_distance);
    distances_[node] = static_cast<float>(inside ? -distance : distance);
    if (inside && distance > 0) {
      directions_[node] = ((nearest.position - point) / distance).cast<float>();
    }
    reach = inside ? (distance + spacing_) * (1 + 1e-9) : std::numeric_limits<double>::infinity();
  }
}

double DistanceField::SignedDistance(const Eigen::Vector3d& point) const {
  const Eigen::Vector3d local = (point - origin_) / spacing_;
  Eigen::Vector3i cell;
  Eigen::Vector3d fraction;
  for (int k = 0; k < 3; ++k) {
    if (!(local[k] >= 0) || local[k] > num_nodes_[k] - 1) return kBandCells * spacing_;
    cell[k] = std::min(static_cast<int>(local[k]), num_nodes_[k] - 2);
    fraction[k] = local[k] - cell[k];
  }
  const int corner = NodeIndex(cell.x(), cell.y(), cell.z());
  const int dy = num_nodes_.x(), dz = num_nodes_.x() * num_nodes_.y();
  const auto along_x = [&](int node) {
    return distances_[node] + fraction.x() * (distances_[node + 1] - distances_[node]);
  };
  const auto along_xy = [&](int node) {
    const double low = along_x(node);
    return low + fraction.y() * (along_x(node + dy) - low);
  };
  const double low = along_xy(corner);
  return low + fraction.z() * (along_xy(corner + dz) - low);
}

double DistanceField::MaxAlongSegment(const Eigen::Vector3d& a, const Eigen::Vector3d& b) const {
  const int num_steps = std::max(1, static_cast<int>(std::ceil((b - a).norm() / (0.5 * spacing_))));
  double largest = -std::numeric_limits<double>::infinity();
  for (int k = 0; k <= num_steps; ++k) {
    largest = std::max(largest, SignedDistance(a + (b - a) * (static_cast<double>(k) / num_steps)));
  }
  return largest;
}

}  // namespace pleat
