// Crash-safe writing of a file whose bytes lie in several places.
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "absl/status/status.h"

namespace pleat {

// As WriteFile (file.h), with the parts one after the other: large files need no copy in memory.
absl::Status WriteFileParts(const std::string& path, std::span<const std::string_view> parts,
                            unsigned mode = 0644);

}  // namespace pleat
