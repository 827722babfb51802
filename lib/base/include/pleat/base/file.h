// Whole-file reading and crash-safe writing.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "absl/status/status.h"
#include "absl/status/statusor.h"

namespace pleat {

// Returns the bytes of the regular file `path`. The error is kNotFound when it does not exist,
// kInvalidArgument when it is no regular file (a folder or a device), and kResourceExhausted when
// it is larger than `max_bytes`. Other failures have the code of their errno.
absl::StatusOr<std::string> ReadFile(const std::string& path,
                                     uint64_t max_bytes = uint64_t{1} << 36);

// Writes `bytes` to a temporary file beside `path`, syncs it and renames it over `path`, so that
// readers see the old content or the new one, never a part of it, even after a crash. Missing
// parent folders are created. On an error the old file is untouched and the temporary one is
// removed. mode: the permissions of the file, from its first moment.
absl::Status WriteFile(const std::string& path, std::string_view bytes, unsigned mode = 0644);

}  // namespace pleat
