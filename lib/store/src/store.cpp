#include "pleat/store/store.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <filesystem>
#include <set>
#include <system_error>
#include <utility>

#include "absl/strings/str_cat.h"
#include "pleat/base/file.h"
#include "pleat/base/status.h"

namespace pleat {
namespace {

constexpr int kUploadAgeHours = 7 * 24;  // an upload that nobody has touched since is forgotten

// The lock ends with the process, however it ends.
absl::StatusOr<int> LockFolder(const std::string& path, const std::string& data_dir) {
  const int fd = open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644);
  if (fd < 0) return absl::ErrnoToStatus(errno, absl::StrCat("cannot open '", path, "'"));
  if (flock(fd, LOCK_EX | LOCK_NB) != 0) {
    close(fd);
    const absl::StatusOr<std::string> holder = ReadFile(path, 64);
    return absl::FailedPreconditionError(
        absl::StrCat("the data folder '", data_dir, "' is in use by another process",
                     holder.ok() && !holder->empty() ? absl::StrCat(" (", *holder, ")") : "",
                     "; stop it or choose another --data-dir"));
  }
  const std::string holder = absl::StrCat("process ", getpid());
  if (ftruncate(fd, 0) != 0 ||
      pwrite(fd, holder.data(), holder.size(), 0) != static_cast<ssize_t>(holder.size())) {
    const absl::Status status =
        absl::ErrnoToStatus(errno, absl::StrCat("cannot write '", path, "'"));
    close(fd);
    return status;
  }
  return fd;
}

}  // namespace

// Holds one id against other changes of the same id, as long as it lives.
class Store::IdLock {
 public:
  IdLock(Store* store, const std::string& id) : store_(store), id_(id) {
    std::unique_lock lock(store_->ids_mutex_);
    store_->id_free_.wait(lock, [this] { return store_->busy_ids_.insert(id_).second; });
  }
  ~IdLock() {
    {
      std::lock_guard lock(store_->ids_mutex_);
      store_->busy_ids_.erase(id_);
    }
    store_->id_free_.notify_all();
  }
  IdLock(const IdLock&) = delete;
  IdLock& operator=(const IdLock&) = delete;

 private:
  Store* const store_;
  const std::string id_;
};

absl::StatusOr<std::unique_ptr<Store>> Store::Open(const StoreOptions& options) {
  if (options.data_dir.empty()) return absl::InvalidArgumentError("the data folder has no name");
  std::error_code error;
  std::filesystem::create_directories(options.data_dir, error);
  if (error) {
    return absl::ErrnoToStatus(error.value(),
                               absl::StrCat("cannot create '", options.data_dir, "'"));
  }
  std::unique_ptr<Store> store(new Store);
  PLEAT_ASSIGN_OR_RETURN(store->lock_fd_, LockFolder(options.data_dir + "/lock", options.data_dir));
  PLEAT_ASSIGN_OR_RETURN(
      BlobStore blobs,
      BlobStore::Open(options.data_dir + "/blobs", options.reserve_bytes, options.before_sync));
  store->blobs_ = std::make_unique<BlobStore>(std::move(blobs));
  PLEAT_RETURN_IF_ERROR(store->blobs_->CheckSpace(0));
  PLEAT_ASSIGN_OR_RETURN(store->catalog_,
                         Catalog::Open(options.data_dir + "/catalogue.db", options.before_sync));
  PLEAT_ASSIGN_OR_RETURN(store->uploads_, UploadArea::Open(options.data_dir + "/uploads",
                                                           kUploadAgeHours, options.before_sync));
  PLEAT_RETURN_IF_ERROR(store->Clean());
  return store;
}

Store::~Store() {
  catalog_.reset();  // before the lock goes
  if (lock_fd_ >= 0) close(lock_fd_);
}

absl::Status Store::Add(EntryKind kind, const CatalogEntry& entry, std::string_view bytes) {
  while (true) {
    PLEAT_ASSIGN_OR_RETURN(StagedFile file, blobs_->Stage(bytes));
    if (file.id() != entry.id) {
      return absl::InvalidArgumentError(absl::StrCat("a file with the SHA-256 ", file.id(),
                                                     " cannot be stored as '", entry.id, "'"));
    }
    const IdLock lock(this, entry.id);
    // Deleted between Stage and the lock: write it after all.
    if (file.already_stored() && !blobs_->Contains(entry.id)) continue;
    PLEAT_RETURN_IF_ERROR(blobs_->Publish(std::move(file)));
    return catalog_->Put(kind, entry);
  }
}

absl::Status Store::Add(EntryKind kind, const CatalogEntry& entry, Upload* upload) {
  if (upload->id() != entry.id) {
    return absl::InvalidArgumentError(
        absl::StrCat("the upload ", upload->id(), " cannot be stored as '", entry.id, "'"));
  }
  PLEAT_ASSIGN_OR_RETURN(StagedFile file, upload->Stage());
  const IdLock lock(this, entry.id);
  PLEAT_RETURN_IF_ERROR(blobs_->Publish(std::move(file)));
  return catalog_->Put(kind, entry);
}

absl::Status Store::Delete(EntryKind kind, const std::string& id) {
  const IdLock lock(this, id);
  PLEAT_RETURN_IF_ERROR(catalog_->Delete(kind, id));
  return blobs_->Delete(id);
}

absl::Status Store::Clean() {
  std::set<std::string> known;
  for (const EntryKind kind :
       {EntryKind::kSequence, EntryKind::kModel, EntryKind::kCompressedSequence, EntryKind::kRig}) {
    PLEAT_ASSIGN_OR_RETURN(const std::vector<CatalogEntry> entries, catalog_->List(kind));
    for (const CatalogEntry& entry : entries) known.insert(entry.id);
  }
  PLEAT_ASSIGN_OR_RETURN(const std::vector<std::string> files, blobs_->List());
  for (const std::string& id : files) {
    if (!known.contains(id)) PLEAT_RETURN_IF_ERROR(blobs_->Delete(id));
    known.erase(id);
  }
  missing_files_.assign(known.begin(), known.end());
  return absl::OkStatus();
}

}  // namespace pleat
