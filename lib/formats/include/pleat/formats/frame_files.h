// Which files form a sequence, and in which order.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "absl/status/status.h"

namespace pleat {

// Compares in natural order: runs of digits count as numbers, so "frame2" comes before "frame10".
bool NaturalLess(std::string_view a, std::string_view b);

// Sorts `paths` in natural order and checks file names that form a numbered series, which means
// that they differ in one number only. kInvalidArgument names a number that is missing or that is
// there twice ("f2" beside "f02"), or a name that does not belong to the series. Numbers may have a
// constant step (0, 5, 10, ...). Names that form no series are taken in the order in which they
// sort.
absl::Status SortFrameFiles(std::vector<std::string>* paths);

}  // namespace pleat
