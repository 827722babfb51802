// Joints that a person placed, as they stand on the command line.
#pragma once

#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "pleat/rigging/penalties.h"

namespace pleat {

// Each text is NAME=x,y,z, a joint of the human template and meters. A usage error names the text
// that is none, or the joint that is placed twice.
absl::StatusOr<std::vector<PlacedJoint>> ParsePlacedJoints(const std::vector<std::string>& texts);

}  // namespace pleat
