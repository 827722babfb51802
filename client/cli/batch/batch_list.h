// The takes of a batch, as a list names them.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "absl/status/statusor.h"

namespace pleat {

struct BatchTake {
  std::string name{};                 // of the result; no two takes have the same
  std::vector<std::string> inputs{};  // paths; several are clips of one character
  int line = 0;                       // of the list, from 1
};

// A line is a path, or JSON: {"input": PATH or [PATH, ...], "name": NAME}. Empty lines and lines
// that begin with '#' say nothing. Paths are relative to `folder`. A take without a name is named
// after its first input, with as many of the folders above as tell it from all others.
// kInvalidArgument names the line that is wrong.
absl::StatusOr<std::vector<BatchTake>> ParseBatchList(std::string_view text,
                                                      const std::string& folder);

}  // namespace pleat
