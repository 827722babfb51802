// Whole-file reading and crash-safe writing.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "absl/status/status.h"
#include "absl/status/statusor.h"

namespace pleat {

// The bytes of the regular file `path`. kNotFound when it does not exist, kResourceExhausted when
// it is larger than `max_bytes`.
absl::StatusOr<std::string> ReadFile(const std::string& path,
                                     uint64_t max_bytes = uint64_t{1} << 36);

// Writes `bytes` to a temporary file beside `path`, syncs it and renames it over `path`: readers
// see the old or the new content, never a part. Creates missing parent folders.
absl::Status WriteFile(const std::string& path, std::string_view bytes);

}  // namespace pleat
