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
constexpr size_t kVerifyStepBytes = size_t{1} << 20;

// Says whether a file has the name of one that Stage did not finish, and no other name.
bool IsUnfinished(const std::string& name) {
  constexpr size_t kSuffixLength = sizeof(kTemporarySuffix) - 1;
  return name.size() == kContentIdLength + kSuffixLength &&
         IsContentId(std::string_view(name).substr(0, kContentIdLength)) &&
         name.compare(kContentIdLength, 5, ".tmp-") == 0;
}

absl::Status NoSuchBlob(const std::string& id) {
  return absl::NotFoundError(absl::StrCat("no stored file has the id '", id, "'"));
}

// Names the file by its id: no path of the server is for the eyes of a client.
absl::Status CannotRead(const std::string& id) {
  return absl::UnavailableError(
      absl::StrCat("cannot read the stored file '", id, "': the disk gives an error"));
}

// From errno.
absl::Status CannotStore(const std::string& id) {
  return ErrnoStatus(errno, absl::StrCat("cannot store the file '", id, "'"));
}

absl::Status HasChanged(const std::string& id) {
  return absl::DataLossError(absl::StrCat("the stored file '", id,
                                          "' has changed on the disk; restore it from a backup, "
                                          "upload it again, or delete the entry"));
}

absl::Status MakeFolder(const std::string& path) {
  std::error_code error;
  fs::create_directories(path, error);
  if (!error) return absl::OkStatus();
  return ErrnoStatus(error.value(), "cannot create a folder of the store");
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
  for (fs::recursive_directory_iterator it(folder, error), end; !error && it != end;
       it.increment(error)) {
    if (IsUnfinished(it->path().filename())) unfinished.push_back(it->path());
  }
  for (const fs::path& path : unfinished) fs::remove(path, error);
  std::shared_ptr<DiskSpace> space = DiskSpace::Of(folder, reserve_bytes);
  return BlobStore(std::move(folder), std::move(space), std::move(before_sync));
}

BlobStore BlobStore::OpenReadOnly(std::string folder) {
  std::shared_ptr<DiskSpace> space = DiskSpace::Of(folder, 0);
  return BlobStore(std::move(folder), std::move(space), {});
}

std::string BlobStore::FolderOf(const std::string& id) const {
  return absl::StrCat(folder_, "/", id.substr(0, 2));
}

std::string BlobStore::PathOf(const std::string& id) const {
  return absl::StrCat(FolderOf(id), "/", id);
}

absl::StatusOr<StagedFile> BlobStore::Stage(std::string_view bytes, IfThere if_there) {
  std::string id = ToHex(ComputeSha256(bytes));
  // A file that is there but damaged is written anew; Publish puts the new one in its place.
  if (if_there == IfThere::kKeep && Verify(id).ok())
    return StagedFile::AlreadyStored(std::move(id));
  PLEAT_ASSIGN_OR_RETURN(const SpaceReservation room, ReserveSpace(bytes.size()));
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
  absl::StatusOr<std::string> bytes = ReadFile(PathOf(id));
  if (!bytes.ok()) return CannotRead(id);
  if (ToHex(ComputeSha256(*bytes)) != id) return HasChanged(id);
  return bytes;
}

absl::Status BlobStore::Verify(const std::string& id) const {
  if (!Contains(id)) return NoSuchBlob(id);
  std::ifstream file(PathOf(id), std::ios::binary);
  std::string step(kVerifyStepBytes, '\0');
  Sha256 hash;
  do {
    file.read(step.data(), static_cast<std::streamsize>(step.size()));
    hash.Update(std::string_view(step).substr(0, static_cast<size_t>(file.gcount())));
  } while (file);
  if (!file.eof()) return CannotRead(id);
  return ToHex(hash.Finish()) == id ? absl::OkStatus() : HasChanged(id);
}

absl::StatusOr<std::unique_ptr<OpenFile>> BlobStore::OpenForReading(const std::string& id) const {
  if (!IsContentId(id)) return NoSuchBlob(id);
  return OpenFile::Open(PathOf(id), id);
}

absl::StatusOr<uint64_t> BlobStore::Size(const std::string& id) const {
  if (!Contains(id)) return NoSuchBlob(id);
  std::error_code error;
  const uint64_t size = fs::file_size(PathOf(id), error);
  if (error) return ErrnoStatus(error.value(), absl::StrCat("cannot inspect ", id));
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
  if (error) return ErrnoStatus(error.value(), absl::StrCat("cannot delete ", id));
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
  if (error) return ErrnoStatus(error.value(), "cannot list the files of the store");
  std::sort(ids.begin(), ids.end());
  return ids;
}

}  // namespace pleat
