// Counts in messages and stored rows are signed numbers, which must not be negative.
#pragma once

#include <cstdint>

#include "absl/status/status.h"
#include "absl/strings/str_cat.h"

namespace pleat {

// kInvalidArgument, naming `what` and the number, when `count` is negative.
inline absl::Status CheckCount(int64_t count, absl::string_view what) {
  if (count >= 0) return absl::OkStatus();
  return absl::InvalidArgumentError(absl::StrCat(what, " is ", count, ", not a count"));
}

}  // namespace pleat
