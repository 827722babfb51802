#include "pleat/base/file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <system_error>

#include "absl/strings/str_cat.h"
#include "pleat/base/file_parts.h"
#include "pleat/base/status.h"

namespace pleat {
namespace {

// Closes the descriptor when the scope ends.
class FileDescriptor {
 public:
  explicit FileDescriptor(int fd) : fd_(fd) {}
  ~FileDescriptor() {
    if (fd_ >= 0) close(fd_);
  }
  FileDescriptor(const FileDescriptor&) = delete;
  FileDescriptor& operator=(const FileDescriptor&) = delete;
  int get() const { return fd_; }

 private:
  int fd_;
};

// Takes the code from errno, so it must be called directly after the failing call.
absl::Status FileError(absl::string_view action, const std::string& path) {
  const int code = errno;
  return ErrnoStatus(code, absl::StrCat("cannot ", action, " '", path, "'"));
}

// write() may take fewer bytes than it was given, or be interrupted by a signal.
absl::Status WriteAll(int fd, std::string_view bytes, const std::string& path) {
  while (!bytes.empty()) {
    const ssize_t written = write(fd, bytes.data(), bytes.size());
    if (written < 0) {
      if (errno == EINTR) continue;
      return FileError("write", path);
    }
    bytes.remove_prefix(static_cast<size_t>(written));
  }
  return absl::OkStatus();
}

}  // namespace

absl::StatusOr<std::string> ReadFile(const std::string& path, uint64_t max_bytes) {
  FileDescriptor file(open(path.c_str(), O_RDONLY | O_CLOEXEC));
  if (file.get() < 0) return FileError("open", path);
  struct stat info;
  if (fstat(file.get(), &info) != 0) return FileError("inspect", path);
  if (!S_ISREG(info.st_mode)) {
    return absl::InvalidArgumentError(absl::StrCat("'", path, "' is not a regular file"));
  }
  if (static_cast<uint64_t>(info.st_size) > max_bytes) {
    return absl::ResourceExhaustedError(
        absl::StrCat("'", path, "' has ", info.st_size, " bytes, the limit is ", max_bytes));
  }
  std::string bytes(static_cast<size_t>(info.st_size), '\0');
  size_t done = 0;
  while (done < bytes.size()) {
    const ssize_t count = read(file.get(), bytes.data() + done, bytes.size() - done);
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) return FileError("read", path);
    if (count == 0) break;  // the file shrank while we read it
    done += static_cast<size_t>(count);
  }
  bytes.resize(done);
  return bytes;
}

absl::Status WriteFile(const std::string& path, std::string_view bytes, unsigned mode) {
  return WriteFileParts(path, std::span(&bytes, 1), mode);
}

absl::Status WriteFileParts(const std::string& path, std::span<const std::string_view> parts,
                            unsigned mode) {
  const std::filesystem::path parent = std::filesystem::path(path).parent_path();
  if (!parent.empty()) {
    std::error_code error;
    std::filesystem::create_directories(parent, error);
    if (error) {
      return ErrnoStatus(error.value(), absl::StrCat("cannot create '", parent.string(), "'"));
    }
  }
  // The temporary file has to be in the same folder: a rename is atomic only within a file system.
  // mkostemp makes it readable by its owner alone, hence the fchmod. The sync comes before the
  // rename, since some file systems order a rename before the data and would leave an empty file
  // after a crash.
  std::string temporary = absl::StrCat(path, ".tmp-XXXXXX");
  {
    FileDescriptor file(mkostemp(temporary.data(), O_CLOEXEC));
    if (file.get() < 0) return FileError("create a file beside", path);
    absl::Status status;
    for (const std::string_view part : parts) {
      if (status.ok()) status = WriteAll(file.get(), part, path);
    }
    if (status.ok() && fchmod(file.get(), mode) != 0) status = FileError("set the mode of", path);
    if (status.ok() && fsync(file.get()) != 0) status = FileError("sync", path);
    if (status.ok() && rename(temporary.c_str(), path.c_str()) != 0) {
      status = FileError("rename a file to", path);
    }
    if (!status.ok()) {
      unlink(temporary.c_str());
      return status;
    }
  }
  // The rename itself is durable only once the folder is synced. A folder that cannot be opened or
  // synced is no error: the file is complete.
  FileDescriptor folder(open(parent.empty() ? "." : parent.c_str(), O_RDONLY | O_DIRECTORY));
  if (folder.get() >= 0) fsync(folder.get());
  return absl::OkStatus();
}

}  // namespace pleat
