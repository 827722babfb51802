#include "pleat/store/open_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <utility>

#include "absl/strings/str_cat.h"

namespace pleat {
namespace {

// No path of the server is for the eyes of a client.
absl::Status CannotOpen(const std::string& id) {
  return absl::UnavailableError(
      absl::StrCat("cannot read the stored file '", id, "': the disk gives an error"));
}

}  // namespace

OpenFile::OpenFile(std::string id, int fd, uint64_t size_bytes)
    : id_(std::move(id)), fd_(fd), size_bytes_(size_bytes) {}

OpenFile::~OpenFile() { close(fd_); }

absl::StatusOr<std::unique_ptr<OpenFile>> OpenFile::Open(const std::string& path,
                                                         const std::string& id) {
  const int fd = open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (fd < 0 && (errno == ENOENT || errno == ENOTDIR)) {
    return absl::NotFoundError(absl::StrCat("no stored file has the id '", id, "'"));
  }
  if (fd < 0) return CannotOpen(id);
  struct stat file = {};
  if (fstat(fd, &file) != 0 || !S_ISREG(file.st_mode)) {
    close(fd);
    return CannotOpen(id);
  }
  return std::unique_ptr<OpenFile>(new OpenFile(id, fd, static_cast<uint64_t>(file.st_size)));
}

absl::StatusOr<std::string> OpenFile::Read(uint64_t offset, uint64_t count) const {
  if (offset > size_bytes_) {
    return absl::OutOfRangeError(
        absl::StrCat("offset ", offset, " is behind the end of a file of ", size_bytes_, " bytes"));
  }
  std::string bytes(std::min(count, size_bytes_ - offset), '\0');
  size_t done = 0;
  while (done < bytes.size()) {
    const ssize_t got =
        pread(fd_, bytes.data() + done, bytes.size() - done, static_cast<off_t>(offset + done));
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) return CannotOpen(id_);
    done += static_cast<size_t>(got);
  }
  return bytes;
}

}  // namespace pleat
