// Which files form a sequence, and in which order.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "absl/status/status.h"

namespace pleat {

// Natural order: runs of digits compare as numbers, so "frame2" comes before "frame10".
bool NaturalLess(std::string_view a, std::string_view b);

// Sorts `paths` naturally and checks file names that form a numbered series (equal but for one
// number): kInvalidArgument names a missing number, a doubled one ("f2" beside "f02"), or a name
// that does not belong to the series. A constant step (0, 5, 10, ...) is a series too. Names that
// form no series are taken as they sort.
absl::Status SortFrameFiles(std::vector<std::string>* paths);

}  // namespace pleat
