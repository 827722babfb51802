// Which joint of another skeleton drives which bone of a character, as JSON that people edit
// (docs/formats/joint_map.md).
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"

namespace pleat {

// How the rest of a bone is laid on that of the other skeleton (docs/method/motion.md#rest-poses).
enum class BoneAlignment {
  kDirection,  // it points where the other one points: limbs
  kRotation,   // it turns as the other one turns, and keeps the build of the character: the trunk
  kSole,       // it is flat on the floor when the other one is: feet
};
std::string_view BoneAlignmentName(BoneAlignment alignment);

struct JointMapEntry {
  std::string joint;       // of the character; the bone that ends there is driven
  std::string from;        // of the other skeleton, or one of its tips: the same place of the body
  std::string turns_with;  // of the other skeleton: whose rotation the bone has
  BoneAlignment alignment = BoneAlignment::kDirection;
};

enum class ClipUp { kAuto, kY, kZ };
std::string_view ClipUpName(ClipUp axis);

struct JointMap {
  std::vector<JointMapEntry> joints;
  // Joints of the other skeleton that drive nothing, for people who edit the map.
  std::vector<std::string> left_out;
  ClipUp up = ClipUp::kAuto;
  std::optional<double> scale;  // of places; none: by the lengths of the legs
};

// Reads a map from hostile text. kInvalidArgument names the entry and what is wrong,
// kResourceExhausted the limit that is exceeded (4 MB, 4,096 joints).
absl::StatusOr<JointMap> DecodeJointMap(std::string_view text);
absl::StatusOr<JointMap> ReadJointMap(const std::string& path);

std::string EncodeJointMap(const JointMap& map);
absl::Status WriteJointMap(const std::string& path, const JointMap& map);

}  // namespace pleat
