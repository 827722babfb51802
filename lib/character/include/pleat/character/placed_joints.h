// Joints that a person placed, as text: "leftHand=.7,1.4,0 head=0,1.7,0". Flags, model files and
// the wire share this form.
#pragma once

#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "pleat/rigging/penalties.h"

namespace pleat {

inline bool operator==(const PlacedJoint& a, const PlacedJoint& b) {
  return a.joint == b.joint && a.position == b.position;
}

// Reads any number of NAME=x,y,z between spaces: a joint of the human template and meters.
// kInvalidArgument names the part that is none, or the joint that is placed twice.
absl::StatusOr<std::vector<PlacedJoint>> ParsePlacedJoints(absl::string_view text);

// Returns such a text, from which ParsePlacedJoints restores exactly the same positions.
std::string FormatPlacedJoints(const std::vector<PlacedJoint>& placed);

// kInvalidArgument names the first joint that the template does not have, that is placed twice or
// whose position is not finite.
absl::Status CheckPlacedJoints(const std::vector<PlacedJoint>& placed);

}  // namespace pleat
