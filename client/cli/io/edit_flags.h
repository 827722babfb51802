// Edits of motions as they are given on the command line, in the order of their flags.
#pragma once

#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "pleat/formats/edited_motion_file.h"

namespace pleat {

// "--offset-rotation" of the edit "offset_rotation".
std::string EditFlag(EditKind kind);
// What stands behind the flag, for --help: "JOINTS=X,Y,Z", or empty.
std::string EditFlagValue(EditKind kind);
// What the edit does, for --help.
std::string EditFlagHelp(EditKind kind);

// Reads what stands behind the flag of an edit. JOINTS are names joined by '+'. Files that it names
// are read. A usage error says what the text should be.
absl::StatusOr<MotionEdit> ParseEditFlag(EditKind kind, const std::string& text);

// "offset_rotation of head, chest", for people.
std::string DescribeEdit(const MotionEdit& edit);

}  // namespace pleat
