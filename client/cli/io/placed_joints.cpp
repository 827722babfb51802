#include "cli/io/placed_joints.h"

#include <algorithm>
#include <cmath>

#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "absl/strings/str_split.h"
#include "cli/exit_code.h"
#include "pleat/skeleton/human_template.h"

namespace pleat {
namespace {

std::string JointNames() {
  return absl::StrJoin(HumanTemplate().joints(), ", ", [](std::string* out, const Joint& joint) {
    absl::StrAppend(out, joint.name);
  });
}

}  // namespace

absl::StatusOr<std::vector<PlacedJoint>> ParsePlacedJoints(const std::vector<std::string>& texts) {
  std::vector<PlacedJoint> placed;
  for (const std::string& text : texts) {
    const std::pair<std::string, std::string> sides = absl::StrSplit(text, absl::MaxSplits('=', 1));
    const std::vector<std::string> numbers = absl::StrSplit(sides.second, ',');
    PlacedJoint joint{.joint = HumanTemplate().FindJoint(sides.first)};
    if (joint.joint < 0) {
      return UsageError(absl::StrCat("--at ", text, ": '", sides.first, "' is none of the joints ",
                                     JointNames()));
    }
    bool is_point = numbers.size() == 3;
    for (int k = 0; k < 3 && is_point; ++k) {
      is_point =
          absl::SimpleAtod(numbers[k], &joint.position[k]) && std::isfinite(joint.position[k]);
    }
    if (!is_point) {
      return UsageError(absl::StrCat("--at ", text, ": after the = come three numbers x,y,z"));
    }
    if (std::ranges::find(placed, joint.joint, &PlacedJoint::joint) != placed.end()) {
      return UsageError(absl::StrCat("--at places ", sides.first, " twice"));
    }
    placed.push_back(joint);
  }
  return placed;
}

}  // namespace pleat
