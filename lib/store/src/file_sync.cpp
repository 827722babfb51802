#include "file_sync.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>

#include "pleat/base/status.h"

namespace pleat {

absl::Status SyncFile(int fd, const std::string& path, const SyncHook& hook) {
  if (hook) hook(path);
  if (fsync(fd) == 0) return absl::OkStatus();
  return ErrnoStatus(errno, "cannot sync a file of the store");
}

absl::Status SyncFolder(const std::string& path, const SyncHook& hook) {
  if (hook) hook(path);
  const int fd = open(path.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (fd < 0) return ErrnoStatus(errno, "cannot open a folder of the store");
  const int error = fsync(fd) == 0 ? 0 : errno;
  close(fd);
  // Some file systems (FUSE, network) cannot sync folders and say so with EINVAL.
  if (error == 0 || error == EINVAL) return absl::OkStatus();
  return ErrnoStatus(error, "cannot sync a folder of the store");
}

}  // namespace pleat
