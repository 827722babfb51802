#include "pleat/character/placed_joints.h"

#include <charconv>
#include <cstdint>

#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "absl/strings/str_split.h"
#include "pleat/base/status.h"
#include "pleat/base/utf8.h"
#include "pleat/skeleton/human_template.h"

namespace pleat {
namespace {

std::string TemplateNames() {
  return absl::StrJoin(HumanTemplate().joints(), ", ", [](std::string* out, const Joint& joint) {
    absl::StrAppend(out, joint.name);
  });
}

// Returns the shortest decimal text that reads back as the same value.
std::string ShortestText(double value) {
  char text[40];
  return std::string(text, std::to_chars(text, text + sizeof(text), value).ptr);
}

absl::StatusOr<PlacedJoint> ParseOne(absl::string_view text) {
  const std::pair<absl::string_view, absl::string_view> sides =
      absl::StrSplit(text, absl::MaxSplits('=', 1));
  const std::string name(sides.first);
  PlacedJoint placed{.joint = HumanTemplate().FindJoint(name)};
  if (placed.joint < 0) {
    return absl::InvalidArgumentError(
        absl::StrCat("'", EscapeControls(name), "' is none of the joints ", TemplateNames()));
  }
  const std::vector<absl::string_view> numbers = absl::StrSplit(sides.second, ',');
  bool is_point = numbers.size() == 3;
  for (size_t k = 0; k < 3 && is_point; ++k) {
    is_point = absl::SimpleAtod(numbers[k], &placed.position[static_cast<Eigen::Index>(k)]);
  }
  if (is_point) return placed;
  return absl::InvalidArgumentError(absl::StrCat("'", EscapeControls(std::string(text)),
                                                 "': after the = come three numbers x,y,z"));
}

}  // namespace

absl::StatusOr<std::vector<PlacedJoint>> ParsePlacedJoints(absl::string_view text) {
  std::vector<PlacedJoint> placed;
  for (const absl::string_view part : absl::StrSplit(text, ' ', absl::SkipEmpty())) {
    PLEAT_ASSIGN_OR_RETURN(const PlacedJoint joint, ParseOne(part));
    placed.push_back(joint);
    PLEAT_RETURN_IF_ERROR(CheckPlacedJoints(placed));
  }
  return placed;
}

std::string FormatPlacedJoints(const std::vector<PlacedJoint>& placed) {
  return absl::StrJoin(placed, " ", [](std::string* out, const PlacedJoint& joint) {
    absl::StrAppend(out, HumanTemplate().joint(joint.joint).name, "=",
                    ShortestText(joint.position.x()), ",", ShortestText(joint.position.y()), ",",
                    ShortestText(joint.position.z()));
  });
}

absl::Status CheckPlacedJoints(const std::vector<PlacedJoint>& placed) {
  uint32_t seen = 0;  // a bit for each of the 18 joints
  for (const auto& [joint, position] : placed) {
    if (joint < 0 || joint >= kNumHumanJoints) {
      return absl::InvalidArgumentError(absl::StrCat("there is no joint ", joint, " to place"));
    }
    const std::string& name = HumanTemplate().joint(joint).name;
    if (!position.allFinite()) {
      return absl::InvalidArgumentError(
          absl::StrCat(name, ": after the = come three numbers x,y,z, which must be finite"));
    }
    if ((seen >> joint & 1) != 0) {
      return absl::InvalidArgumentError(absl::StrCat(name, " is placed twice"));
    }
    seen |= uint32_t{1} << joint;
  }
  return absl::OkStatus();
}

}  // namespace pleat
