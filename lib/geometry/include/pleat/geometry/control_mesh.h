// The control mesh: a subset of the vertices, so that it animates by index
// (docs/method/details.md#control-mesh).
#pragma once

#include <Eigen/Core>
#include <vector>

#include "absl/status/statusor.h"
#include "pleat/mesh/topology.h"

namespace pleat {

// Chooses round(fraction * V) vertices, ascending, of the mesh in the frame `reference` (3 x V,
// meters). Half of them are what edge-collapse simplification by meshoptimizer (quadric error
// metric, Garland and Heckbert 1997) leaves, which is a subset of the vertices. The other half fill
// the largest gaps, and all are centered in the cells they serve: the flat places that a
// simplification leaves bare are where cloth folds in other frames. Every connected component keeps
// at least one vertex, which can raise the count; coincident vertices count as connected. A
// fraction of 1 returns all vertices. Deterministic. The error is kInvalidArgument when the
// fraction is not in (0, 1] or the counts of `topology` and `reference` differ.
absl::StatusOr<std::vector<int>> SelectControlVertices(const Topology& topology,
                                                       const Eigen::Matrix3Xd& reference,
                                                       double fraction);

}  // namespace pleat
