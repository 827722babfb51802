// The right of one process to change what a lock file stands for.
#pragma once

#include <sys/types.h>

#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "absl/status/statusor.h"

namespace pleat {

// An exclusive flock, held as long as it lives, and at most as long as the process, however that
// ends. The file stays behind. Whoever opens the file again, in this process too, is another
// holder.
class FileLock {
 public:
  // Both make the file when it is missing, with these permissions, and return the error of opening
  // it.
  //
  // Waits until nobody else holds it.
  static absl::StatusOr<FileLock> Wait(const std::string& path, mode_t mode);
  // Nothing when somebody else holds it.
  static absl::StatusOr<std::optional<FileLock>> Try(const std::string& path, mode_t mode);

  ~FileLock();
  FileLock(FileLock&& other) noexcept : fd_(std::exchange(other.fd_, -1)) {}
  FileLock& operator=(FileLock&&) = delete;

  // Makes `text` the content of the file, for people who look: not more than a courtesy, so a full
  // disk is no error.
  void Note(std::string_view text) const;

 private:
  explicit FileLock(int fd) : fd_(fd) {}
  int fd_;
};

}  // namespace pleat
