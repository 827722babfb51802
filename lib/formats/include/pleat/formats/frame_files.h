// Which files form a sequence, and in which order.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "absl/status/statusor.h"
#include "pleat/mesh/input_note.h"

namespace pleat {

// Natural order: runs of digits compare as numbers, so "frame2" comes before "frame10".
bool NaturalLess(std::string_view a, std::string_view b);

struct FrameFiles {
  std::vector<std::string> paths;  // in the order of the frames
  std::vector<InputNote> notes;
};

// The frames among `paths` in their order. File names that are equal but for one number form a
// series; it may count in steps (0, 5, 10, ...), begin below zero ("f_-1", or "f-1" beside "f0"),
// have gaps or count in time stamps, which notes say. A few files beside a series that are no
// frames of it are left out with a note: a reference mesh, or one other file beside many. Names
// that form no series are taken as they sort. kInvalidArgument names a doubled number ("f2" beside
// "f02") or a second series.
absl::StatusOr<FrameFiles> SortFrameFiles(std::vector<std::string> paths);

}  // namespace pleat
