// What the motion model leaves, as integers per coordinate: the layer that keeps the promise.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "absl/status/status.h"
#include "binary_coder.h"
#include "pleat/geometry/surface_hierarchy.h"

namespace pleat {

enum class ResidualKind : uint8_t {
  kNone = 0,
  // decoded = predicted + q * step; whole vertices are left out where the prediction is good enough
  kCorrection = 1,
  // decoded = origin + (round((predicted - origin) / step) + q) * step: a point of the grid
  kGrid = 2,
};

struct ResidualGrid {
  ResidualKind kind = ResidualKind::kNone;
  double step_m = 0;
  Eigen::Vector3d origin_m = Eigen::Vector3d::Zero();  // kGrid
  double bound_m = 0;                                  // kCorrection: largest distance of a vertex
};

// truth: the frames to encode (null when decoding). frames: the predicted ones, replaced by the
// decoded ones. kInvalidArgument (encoding): a residual has too many steps. kDataLoss (decoding).
absl::Status CodeResiduals(const SurfaceHierarchy& hierarchy, const ResidualGrid& grid,
                           const std::vector<const Eigen::Matrix3Xf*>& truth, BinaryCoder* coder,
                           std::vector<Eigen::Matrix3Xf>* frames);

}  // namespace pleat
