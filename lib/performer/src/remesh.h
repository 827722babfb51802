// Isotropic remeshing of a closed triangle mesh on an implicit surface.
#pragma once

#include <functional>

#include "isosurface.h"

namespace pleat {

struct RemeshOptions {
  std::function<double(const Eigen::Vector3d&)> distance;     // signed, negative inside
  std::function<double(const Eigen::Vector3d&)> edge_length;  // wanted there
  int num_iterations = 8;
};

// Brings all edges near the wanted length and all vertices onto the zero set of `distance`. Splits,
// collapses and flips keep a closed manifold closed, manifold and of the same genus. Only
// kCancelled is an error. `distance` is called from several threads.
absl::StatusOr<TriangleSoup> RemeshIsotropic(TriangleSoup soup, const RemeshOptions& options,
                                             const Progress& progress);

}  // namespace pleat
