// The factors on the lengths of bones that queries bring.
#pragma once

#include <vector>

#include "absl/status/status.h"

namespace pleat {

// OK when there are none, or one within [0.05, 20] for each joint; kInvalidArgument names what is
// wrong.
absl::Status CheckBoneScales(const std::vector<double>& bone_scales, int num_joints);

}  // namespace pleat
