#include "pleat/base/file_lock.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>

#include "absl/strings/str_cat.h"
#include "pleat/base/status.h"

namespace pleat {
namespace {

absl::StatusOr<int> OpenLockFile(const std::string& path, mode_t mode) {
  const int fd = open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, mode);
  if (fd < 0) return ErrnoStatus(errno, absl::StrCat("cannot open '", path, "'"));
  return fd;
}

// 0, or the error that is not an interruption by a signal.
int LockFile(int fd, int operation) {
  while (flock(fd, operation) != 0) {
    if (errno != EINTR) return errno;
  }
  return 0;
}

}  // namespace

absl::StatusOr<FileLock> FileLock::Wait(const std::string& path, mode_t mode) {
  PLEAT_ASSIGN_OR_RETURN(const int fd, OpenLockFile(path, mode));
  FileLock lock(fd);
  const int error = LockFile(fd, LOCK_EX);
  if (error != 0) return ErrnoStatus(error, absl::StrCat("cannot lock '", path, "'"));
  return lock;
}

absl::StatusOr<std::optional<FileLock>> FileLock::Try(const std::string& path, mode_t mode) {
  PLEAT_ASSIGN_OR_RETURN(const int fd, OpenLockFile(path, mode));
  std::optional<FileLock> lock(FileLock{fd});
  const int error = LockFile(fd, LOCK_EX | LOCK_NB);
  if (error == EWOULDBLOCK) return std::optional<FileLock>();
  if (error != 0) return ErrnoStatus(error, absl::StrCat("cannot lock '", path, "'"));
  return lock;
}

void FileLock::Note(std::string_view text) const {
  if (ftruncate(fd_, 0) != 0) return;
  [[maybe_unused]] const ssize_t written = pwrite(fd_, text.data(), text.size(), 0);
}

FileLock::~FileLock() {
  if (fd_ >= 0) close(fd_);
}

}  // namespace pleat
