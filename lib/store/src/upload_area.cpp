#include "pleat/store/upload_area.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <filesystem>
#include <system_error>
#include <utility>

#include "absl/strings/str_cat.h"
#include "file_sync.h"
#include "pleat/base/content_id.h"
#include "pleat/base/file.h"
#include "pleat/base/sha256.h"
#include "pleat/base/status.h"

namespace pleat {
namespace {

namespace fs = std::filesystem;

// Says whether a file is one that Begin made.
bool IsUpload(const fs::path& path) {
  return path.extension() == ".part" && IsContentId(path.stem().string());
}

}  // namespace

Upload::Upload(UploadArea* area, std::string id, std::string path, uint64_t size_bytes, int fd,
               uint64_t received_bytes, SpaceReservation room)
    : room_(std::move(room)),
      area_(area),
      id_(std::move(id)),
      path_(std::move(path)),
      size_bytes_(size_bytes),
      received_bytes_(received_bytes),
      fd_(fd) {}

Upload::~Upload() {
  if (fd_ >= 0) close(fd_);
  area_->Release(id_);
}

absl::Status Upload::Append(std::string_view bytes) {
  if (bytes.size() > size_bytes_ - received_bytes_) {
    return absl::OutOfRangeError(
        absl::StrCat("more than the declared ", size_bytes_, " bytes were sent for upload ", id_));
  }
  while (!bytes.empty()) {
    const ssize_t written = write(fd_, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) return ErrnoStatus(errno, absl::StrCat("cannot write upload ", id_));
    received_bytes_ += static_cast<uint64_t>(written);
    room_.Spend(static_cast<uint64_t>(written));
    bytes.remove_prefix(static_cast<size_t>(written));
  }
  return absl::OkStatus();
}

absl::StatusOr<std::string> Upload::ReadComplete() {
  if (received_bytes_ != size_bytes_) {
    return absl::FailedPreconditionError(absl::StrCat("upload ", id_, " ended after ",
                                                      received_bytes_, " of ", size_bytes_,
                                                      " bytes; go on at that offset"));
  }
  absl::StatusOr<std::string> bytes = ReadFile(path_, size_bytes_);
  if (!bytes.ok()) {
    return absl::Status(bytes.status().code(), absl::StrCat("cannot read upload ", id_));
  }
  if (ToHex(ComputeSha256(*bytes)) != id_) {
    Discard();
    return absl::DataLossError(absl::StrCat("the uploaded bytes do not have the declared SHA-256 ",
                                            id_, "; upload them again from the start"));
  }
  return bytes;
}

absl::StatusOr<StagedFile> Upload::Stage() {
  PLEAT_RETURN_IF_ERROR(SyncFile(fd_, path_, area_->before_sync_));
  return StagedFile(id_, path_, StagedFile::Unpublished::kKeep);
}

void Upload::Discard() {
  if (ftruncate(fd_, 0) == 0) lseek(fd_, 0, SEEK_SET);
  unlink(path_.c_str());
  received_bytes_ = 0;
}

absl::StatusOr<std::unique_ptr<UploadArea>> UploadArea::Open(std::string folder,
                                                             SyncHook before_sync) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) {
    return ErrnoStatus(error.value(), absl::StrCat("cannot create '", folder, "'"));
  }
  return std::unique_ptr<UploadArea>(new UploadArea(std::move(folder), std::move(before_sync)));
}

absl::Status UploadArea::Remove(const std::string& id) {
  if (!IsContentId(id)) {
    return absl::InvalidArgumentError("an upload id must be 64 lower-case hexadecimal digits");
  }
  std::lock_guard lock(mutex_);  // nobody begins it meanwhile
  if (active_.contains(id)) {
    return absl::AbortedError(absl::StrCat("upload ", id, " is being written by another call"));
  }
  std::error_code error;
  if (fs::remove(PathOf(id), error)) return absl::OkStatus();
  if (!error) return absl::NotFoundError(absl::StrCat("nothing has arrived of upload ", id));
  return ErrnoStatus(error.value(), absl::StrCat("cannot remove upload ", id));
}

std::vector<std::string> UploadArea::RemoveUntouchedSince(absl::Time time) {
  std::vector<std::string> old;
  std::error_code error;
  for (fs::directory_iterator it(folder_, error), end; !error && it != end; it.increment(error)) {
    struct stat file = {};
    if (!IsUpload(it->path()) || stat(it->path().c_str(), &file) != 0) continue;
    if (absl::TimeFromTimespec(file.st_mtim) < time) old.push_back(it->path().stem());
  }
  std::erase_if(old, [this](const std::string& id) { return !Remove(id).ok(); });
  std::sort(old.begin(), old.end());
  return old;
}

uint64_t UploadArea::TotalBytes() const {
  uint64_t bytes = 0;
  std::error_code error;
  for (fs::directory_iterator it(folder_, error), end; !error && it != end; it.increment(error)) {
    struct stat file = {};
    if (!IsUpload(it->path()) || stat(it->path().c_str(), &file) != 0) continue;
    bytes += static_cast<uint64_t>(file.st_size);
  }
  return bytes;
}

uint64_t UploadArea::ReceivedBytes(const std::string& id) const {
  if (!IsContentId(id)) return 0;
  std::error_code error;
  const uint64_t size = fs::file_size(PathOf(id), error);
  return error ? 0 : size;
}

absl::StatusOr<std::unique_ptr<Upload>> UploadArea::Begin(const std::string& id,
                                                          uint64_t size_bytes,
                                                          uint64_t offset_bytes,
                                                          SpaceReservation room) {
  if (!IsContentId(id)) {
    return absl::InvalidArgumentError("an upload id must be 64 lower-case hexadecimal digits");
  }
  {
    std::lock_guard lock(mutex_);
    if (!active_.insert(id).second) {
      return absl::AbortedError(absl::StrCat("upload ", id, " is being written by another call"));
    }
  }
  const int flags = O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC | (offset_bytes == 0 ? O_TRUNC : 0);
  const int fd = open(PathOf(id).c_str(), flags, 0644);
  if (fd < 0) {
    const absl::Status status = ErrnoStatus(errno, absl::StrCat("cannot write upload ", id));
    Release(id);
    return status;
  }
  std::unique_ptr<Upload> upload(
      new Upload(this, id, PathOf(id), size_bytes, fd, ReceivedBytes(id), std::move(room)));
  if (upload->received_bytes() != offset_bytes || offset_bytes > size_bytes) {
    return absl::OutOfRangeError(absl::StrCat("upload ", id, " of ", size_bytes, " bytes has ",
                                              upload->received_bytes(), ", so it cannot go on at ",
                                              offset_bytes, "; go on there, or start again at 0"));
  }
  return upload;
}

void UploadArea::Release(const std::string& id) {
  std::lock_guard lock(mutex_);
  active_.erase(id);
}

}  // namespace pleat
