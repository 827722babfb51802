// Content ids: stored files are named by the SHA-256 of their bytes.
#pragma once

#include <string_view>

#include "absl/status/status.h"
#include "absl/strings/string_view.h"

namespace pleat {

inline constexpr int kContentIdLength = 64;  // hexadecimal digits of a SHA-256

// True for 64 lower-case hexadecimal digits: nothing else may become the name of a file.
bool IsContentId(std::string_view id);

// kInvalidArgument names `what` when `id` is no content id. Call it on every id that comes from
// outside, before anything is looked up.
absl::Status CheckContentId(std::string_view id, absl::string_view what);

}  // namespace pleat
