// The right of one process to change a data folder.
#pragma once

#include <string>

#include "absl/status/statusor.h"
#include "pleat/base/file_lock.h"

namespace pleat {

// kFailedPrecondition names the process that holds the folder.
absl::StatusOr<FileLock> LockFolder(const std::string& data_dir);

}  // namespace pleat
