// Recognizes files that are something else than what their name says.
#pragma once

#include <string>
#include <string_view>

#include "absl/status/status.h"

namespace pleat {

// What the first bytes of a file say when they belong to a format that no reader here knows, with
// what to do about it: UTF-16 text, pointers of Git LFS and git-annex, HDF5, archives, FBX, ...
// Empty when they are nothing of the kind.
std::string DescribeForeignBytes(std::string_view bytes);

// kInvalidArgument "file: ..." with that description, OK when there is none.
absl::Status RefuseForeignBytes(std::string_view bytes, std::string_view file);

// The same for the first bytes of the file `path`; OK when it cannot be read.
absl::Status RefuseForeignFile(const std::string& path);

}  // namespace pleat
