#include "pleat/store/blob_store.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <system_error>
#include <utility>

#include "absl/strings/str_cat.h"
#include "pleat/base/content_id.h"
#include "pleat/base/file.h"
#include "pleat/base/sha256.h"
#include "pleat/base/status.h"

namespace pleat {
namespace {

namespace fs = std::filesystem;

absl::Status NoSuchBlob(const std::string& id) {
  return absl::NotFoundError(absl::StrCat("no stored file has the id '", id, "'"));
}

}  // namespace

absl::StatusOr<BlobStore> BlobStore::Open(std::string folder, uint64_t reserve_bytes) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) {
    return absl::ErrnoToStatus(error.value(), absl::StrCat("cannot create '", folder, "'"));
  }
  // What a crash left of unfinished writes.
  std::vector<fs::path> unfinished;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder, error)) {
    if (entry.path().extension().string().starts_with(".tmp-")) unfinished.push_back(entry.path());
  }
  for (const fs::path& path : unfinished) fs::remove(path, error);
  return BlobStore(std::move(folder), reserve_bytes);
}

std::string BlobStore::PathOf(const std::string& id) const {
  return absl::StrCat(folder_, "/", id.substr(0, 2), "/", id);
}

absl::StatusOr<std::string> BlobStore::Put(std::string_view bytes) {
  std::string id = ToHex(ComputeSha256(bytes));
  if (Contains(id)) return id;
  PLEAT_RETURN_IF_ERROR(CheckSpace(bytes.size()));
  PLEAT_RETURN_IF_ERROR(WriteFile(PathOf(id), bytes));
  return id;
}

absl::Status BlobStore::Adopt(const std::string& path, const std::string& id) {
  if (!IsContentId(id)) return NoSuchBlob(id);
  const std::string target = PathOf(id);
  const std::string parent = fs::path(target).parent_path();
  std::error_code error;
  fs::create_directories(parent, error);
  if (error) {
    return absl::ErrnoToStatus(error.value(), absl::StrCat("cannot create '", parent, "'"));
  }
  // Content first, then the name, then the folder: the order that survives a crash.
  const int file = open(path.c_str(), O_RDONLY | O_CLOEXEC);
  const bool synced = file >= 0 && fsync(file) == 0;
  if (file >= 0) close(file);
  if (!synced || rename(path.c_str(), target.c_str()) != 0) {
    return absl::ErrnoToStatus(errno, absl::StrCat("cannot move an upload to '", target, "'"));
  }
  for (const std::string& changed : {parent, folder_}) {
    const int folder = open(changed.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (folder >= 0) {
      fsync(folder);
      close(folder);
    }
  }
  return absl::OkStatus();
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
