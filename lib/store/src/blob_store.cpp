#include "pleat/store/blob_store.h"

#include <fcntl.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <filesystem>
#include <fstream>
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

constexpr char kTemporarySuffix[] = ".tmp-XXXXXX";  // for mkostemp; Open removes what is left

absl::Status NoSuchBlob(const std::string& id) {
  return absl::NotFoundError(absl::StrCat("no stored file has the id '", id, "'"));
}

// From errno.
absl::Status CannotStore(const std::string& id) {
  return absl::ErrnoToStatus(errno, absl::StrCat("cannot store the file '", id, "'"));
}

absl::Status MakeFolder(const std::string& path) {
  std::error_code error;
  fs::create_directories(path, error);
  if (!error) return absl::OkStatus();
  return absl::ErrnoToStatus(error.value(), absl::StrCat("cannot create '", path, "'"));
}

// False with errno set when the disk does not take all of them.
bool WriteAll(int fd, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t written = write(fd, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) return false;
    bytes.remove_prefix(static_cast<size_t>(written));
  }
  return true;
}

}  // namespace

absl::StatusOr<BlobStore> BlobStore::Open(std::string folder, uint64_t reserve_bytes,
                                          SyncHook before_sync) {
  PLEAT_RETURN_IF_ERROR(MakeFolder(folder));
  std::error_code error;
  // What a crash left of unfinished writes.
  std::vector<fs::path> unfinished;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder, error)) {
    if (entry.path().extension().string().starts_with(".tmp-")) unfinished.push_back(entry.path());
  }
  for (const fs::path& path : unfinished) fs::remove(path, error);
  return BlobStore(std::move(folder), reserve_bytes, std::move(before_sync));
}

std::string BlobStore::FolderOf(const std::string& id) const {
  return absl::StrCat(folder_, "/", id.substr(0, 2));
}

std::string BlobStore::PathOf(const std::string& id) const {
  return absl::StrCat(FolderOf(id), "/", id);
}

absl::StatusOr<StagedFile> BlobStore::Stage(std::string_view bytes) {
  std::string id = ToHex(ComputeSha256(bytes));
  if (Contains(id)) return StagedFile::AlreadyStored(std::move(id));
  PLEAT_RETURN_IF_ERROR(CheckSpace(bytes.size()));
  PLEAT_RETURN_IF_ERROR(MakeFolder(FolderOf(id)));
  std::string path = PathOf(id) + kTemporarySuffix;
  const int fd = mkostemp(path.data(), O_CLOEXEC);
  if (fd < 0) return CannotStore(id);
  StagedFile file(std::move(id), std::move(path), StagedFile::Unpublished::kRemove);
  absl::Status status =
      WriteAll(fd, bytes) && fchmod(fd, 0644) == 0 ? absl::OkStatus() : CannotStore(file.id());
  if (status.ok()) status = SyncFile(fd, file.path(), before_sync_);
  close(fd);
  if (!status.ok()) return status;
  return file;
}

absl::Status BlobStore::Publish(StagedFile file) {
  const std::string& id = file.id();
  if (file.already_stored()) {
    if (!Contains(id)) {
      return absl::AbortedError(absl::StrCat("the stored file '", id, "' was deleted meanwhile"));
    }
  } else {
    PLEAT_RETURN_IF_ERROR(MakeFolder(FolderOf(id)));
    if (rename(file.path().c_str(), PathOf(id).c_str()) != 0) return CannotStore(id);
    file.path_.clear();
  }
  // Also for a file that was there: whoever published it may have failed right here.
  PLEAT_RETURN_IF_ERROR(SyncFolder(FolderOf(id), before_sync_));
  return SyncFolder(folder_, before_sync_);
}

absl::StatusOr<std::string> BlobStore::Put(std::string_view bytes) {
  PLEAT_ASSIGN_OR_RETURN(StagedFile file, Stage(bytes));
  std::string id = file.id();
  PLEAT_RETURN_IF_ERROR(Publish(std::move(file)));
  return id;
}

absl::StatusOr<std::string> BlobStore::Get(const std::string& id) const {
  if (!Contains(id)) return NoSuchBlob(id);
  PLEAT_ASSIGN_OR_RETURN(std::string bytes, ReadFile(PathOf(id)));
  if (ToHex(ComputeSha256(bytes)) != id) {
    return absl::DataLossError(absl::StrCat("the stored file '", PathOf(id),
                                            "' has changed on the disk; restore it from a backup "
                                            "or delete the entry and upload it again"));
  }
  return bytes;
}

absl::StatusOr<std::string> BlobStore::GetRange(const std::string& id, uint64_t offset,
                                                uint64_t count) const {
  PLEAT_ASSIGN_OR_RETURN(const uint64_t size, Size(id));
  if (offset > size) {
    return absl::OutOfRangeError(
        absl::StrCat("offset ", offset, " is behind the end of a file of ", size, " bytes"));
  }
  std::string bytes(std::min(count, size - offset), '\0');
  std::ifstream file(PathOf(id), std::ios::binary);
  file.seekg(static_cast<std::streamoff>(offset));
  file.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  if (!file) return absl::DataLossError(absl::StrCat("cannot read '", PathOf(id), "'"));
  return bytes;
}

absl::StatusOr<uint64_t> BlobStore::Size(const std::string& id) const {
  if (!Contains(id)) return NoSuchBlob(id);
  std::error_code error;
  const uint64_t size = fs::file_size(PathOf(id), error);
  if (error) return absl::ErrnoToStatus(error.value(), absl::StrCat("cannot inspect ", id));
  return size;
}

bool BlobStore::Contains(const std::string& id) const {
  std::error_code error;
  return IsContentId(id) && fs::is_regular_file(PathOf(id), error);
}

absl::Status BlobStore::Delete(const std::string& id) {
  if (!IsContentId(id)) return absl::OkStatus();
  std::error_code error;
  fs::remove(PathOf(id), error);
  if (error) return absl::ErrnoToStatus(error.value(), absl::StrCat("cannot delete ", id));
  return absl::OkStatus();
}

absl::StatusOr<std::vector<std::string>> BlobStore::List() const {
  std::vector<std::string> ids;
  std::error_code error;
  for (fs::recursive_directory_iterator it(folder_, error), end; !error && it != end;
       it.increment(error)) {
    const std::string name = it->path().filename();
    if (IsContentId(name)) ids.push_back(name);
  }
  if (error) return absl::ErrnoToStatus(error.value(), absl::StrCat("cannot list '", folder_, "'"));
  std::sort(ids.begin(), ids.end());
  return ids;
}

absl::Status BlobStore::CheckSpace(uint64_t bytes) const {
  std::error_code error;
  const fs::space_info space = fs::space(folder_, error);
  if (error) return absl::ErrnoToStatus(error.value(), "cannot ask for the free disk space");
  if (space.available < reserve_bytes_ || space.available - reserve_bytes_ < bytes) {
    return absl::ResourceExhaustedError(absl::StrCat(
        "no room on the server's disk: ", space.available, " bytes free, ", bytes,
        " needed beside a reserve of ", reserve_bytes_, "; delete sequences or models"));
  }
  return absl::OkStatus();
}

}  // namespace pleat
