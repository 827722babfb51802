// The shape that all motion of a compressed sequence is relative to.
#pragma once

#include <Eigen/Core>

#include "absl/status/status.h"
#include "binary_coder.h"
#include "pleat/mesh/topology.h"

namespace pleat {

// rest: 3 x V, meters; encoding reads it, both directions leave the decoded shape there.
absl::Status CodeRestShape(const Topology& topology, float step_m, BinaryCoder* coder,
                           Eigen::Matrix3Xf* rest);

}  // namespace pleat
