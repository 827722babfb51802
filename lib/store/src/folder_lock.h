// The right of one process to change a data folder.
#pragma once

#include <string>
#include <utility>

#include "absl/status/statusor.h"

namespace pleat {

// Held as long as it lives, and at most as long as the process, however that ends.
class FolderLock {
 public:
  // kFailedPrecondition names the process that holds the folder.
  static absl::StatusOr<FolderLock> Take(const std::string& data_dir);
  ~FolderLock();
  FolderLock(FolderLock&& other) noexcept : fd_(std::exchange(other.fd_, -1)) {}
  FolderLock& operator=(FolderLock&&) = delete;

 private:
  explicit FolderLock(int fd) : fd_(fd) {}
  int fd_;
};

}  // namespace pleat
