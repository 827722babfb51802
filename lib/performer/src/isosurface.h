// Polygonization of an implicit surface by marching tetrahedra.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <functional>
#include <vector>

#include "absl/status/statusor.h"
#include "pleat/base/progress.h"

namespace pleat {

// An indexed triangle mesh while it is being made.
struct TriangleSoup {
  std::vector<Eigen::Vector3d> positions;
  std::vector<std::array<int, 3>> triangles;  // counter-clockwise seen from outside
};

// Extracts the zero set of `distance` (negative inside) in the box [low, high], which must contain
// it completely, sampled with `spacing`. The result is closed and 2-manifold: tetrahedra leave no
// ambiguous case. Only kCancelled is an error. `distance` is called from several threads.
absl::StatusOr<TriangleSoup> ExtractIsosurface(
    const std::function<double(const Eigen::Vector3d&)>& distance, const Eigen::Vector3d& low,
    const Eigen::Vector3d& high, double spacing, const Progress& progress);

}  // namespace pleat
