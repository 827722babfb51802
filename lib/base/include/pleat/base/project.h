// Projects divide one server among groups that must not see each other.
#pragma once

#include <string_view>

#include "absl/status/status.h"

namespace pleat {

// The project of everything that names none: callers without a token, tokens and rows of versions
// that knew no projects.
inline constexpr char kDefaultProject[] = "default";

// A name is 1 to 48 bytes of a-z, 0-9, '-' and '_', and begins with a letter or a digit: it is part
// of paths, labels and logs. kInvalidArgument says what is wrong.
absl::Status CheckProjectName(std::string_view name);

}  // namespace pleat
