#include "pleat/store/store_backup.h"

#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <system_error>
#include <unordered_set>
#include <utility>

#include "absl/strings/str_cat.h"
#include "file_sync.h"
#include "folder_lock.h"
#include "pleat/base/status.h"
#include "pleat/store/blob_store.h"
#include "pleat/store/catalog.h"
#include "store_identity.h"

namespace pleat {
namespace {

namespace fs = std::filesystem;

void RemoveDatabase(const std::string& path) {
  std::error_code ignored;
  for (const char* suffix : kCatalogSuffixes) fs::remove(path + suffix, ignored);
}

// True when the folder is missing, or holds nothing but the lock that a process leaves.
bool IsFree(const std::string& folder) {
  std::error_code error;
  if (!fs::exists(folder, error)) return true;
  for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error)) {
    if (it->path().filename() != "lock") return false;
  }
  return !error;
}

// One copy of a store, from the snapshot of its catalog to the removal of what is old.
class StoreCopier {
 public:
  StoreCopier(std::string from, std::string to) : from_(std::move(from)), to_(std::move(to)) {}

  absl::StatusOr<StoreCopy> Run(const Progress& progress) {
    PLEAT_ASSIGN_OR_RETURN(source_, Catalog::OpenReadOnly(CatalogPath(from_)));
    PLEAT_RETURN_IF_ERROR(Prepare());
    PLEAT_ASSIGN_OR_RETURN(const FileLock lock, LockFolder(to_));
    PLEAT_ASSIGN_OR_RETURN(BlobStore to_blobs, BlobStore::Open(to_ + "/blobs", 0));
    PLEAT_RETURN_IF_ERROR(WriteBlobsId(to_blobs.folder(), store_id_));
    const std::string snapshot_path = CatalogPath(to_) + ".new";
    RemoveDatabase(snapshot_path);
    PLEAT_RETURN_IF_ERROR(source_->CopyTo(snapshot_path));
    std::vector<std::string> ids;
    {
      PLEAT_ASSIGN_OR_RETURN(const std::unique_ptr<Catalog> snapshot, Catalog::Open(snapshot_path));
      PLEAT_RETURN_IF_ERROR(snapshot->SetStoreId(store_id_));
      PLEAT_ASSIGN_OR_RETURN(ids, snapshot->FileIds());
      PLEAT_RETURN_IF_ERROR(CopyFiles(ids, &to_blobs, snapshot.get(), progress));
      PLEAT_ASSIGN_OR_RETURN(ids,
                             snapshot->FileIds());  // without those that were deleted meanwhile
    }
    PLEAT_RETURN_IF_ERROR(Publish(snapshot_path));
    PLEAT_RETURN_IF_ERROR(RemoveOld(ids, &to_blobs));
    PLEAT_RETURN_IF_ERROR(progress.Report(1));
    return std::move(copy_);
  }

 private:
  // Refuses a folder that is not this store's backup, and makes a new one.
  absl::Status Prepare() {
    PLEAT_ASSIGN_OR_RETURN(store_id_, source_->StoreId());
    if (store_id_.empty()) {
      return absl::FailedPreconditionError(
          absl::StrCat("the store in '", from_,
                       "' has no id yet: it was made by Pleat 0.1.0. Start "
                       "the server once, which gives it one"));
    }
    if (!IsFree(to_)) {
      PLEAT_ASSIGN_OR_RETURN(const std::string other, ReadBlobsId(to_ + "/blobs"));
      if (other != store_id_) {
        return absl::FailedPreconditionError(
            absl::StrCat("'", to_, "' is not empty and ",
                         other.empty() ? "no backup" : "holds another store (" + other + ")",
                         "; choose an empty folder, or the backup of the store ", store_id_));
      }
    }
    std::error_code error;
    fs::create_directories(to_, error);
    if (error) return ErrnoStatus(error.value(), absl::StrCat("cannot create '", to_, "'"));
    return absl::OkStatus();
  }

  absl::Status CopyFiles(const std::vector<std::string>& ids, BlobStore* to_blobs,
                         Catalog* snapshot, const Progress& progress) {
    const BlobStore from_blobs = BlobStore::OpenReadOnly(from_ + "/blobs");
    const Progress copying = progress.Stage("copy", 0, 1);
    for (size_t i = 0; i < ids.size(); ++i) {
      PLEAT_RETURN_IF_ERROR(copying.Report(static_cast<double>(i) / ids.size()));
      const std::string& id = ids[i];
      const absl::StatusOr<uint64_t> size = from_blobs.Size(id), have = to_blobs->Size(id);
      if (size.ok() && have.ok() && *size == *have) {
        ++copy_.num_kept;
        continue;
      }
      const absl::StatusOr<std::string> bytes = from_blobs.Get(id);
      if (bytes.ok()) {
        PLEAT_RETURN_IF_ERROR(to_blobs->Put(*bytes).status());
        ++copy_.num_copied;
        copy_.bytes_copied += bytes->size();
      } else {
        PLEAT_RETURN_IF_ERROR(LeaveOut(id, bytes.status(), snapshot));
      }
    }
    return absl::OkStatus();
  }

  // An entry that was deleted since the snapshot goes from the snapshot too; any other file that
  // cannot be copied is a problem, and its entry stays.
  absl::Status LeaveOut(const std::string& id, const absl::Status& why, Catalog* snapshot) {
    PLEAT_ASSIGN_OR_RETURN(const bool is_named, source_->NamesFile(id));
    if (!is_named) {
      return snapshot->DeleteInAllProjects(id);
    }
    copy_.problems.push_back(FileProblem(id, why));
    return absl::OkStatus();
  }

  // The snapshot takes the place of the catalog of the backup before.
  absl::Status Publish(const std::string& snapshot_path) {
    std::error_code ignored;
    for (const char* suffix : {"-wal", "-shm"}) fs::remove(CatalogPath(to_) + suffix, ignored);
    if (rename(snapshot_path.c_str(), CatalogPath(to_).c_str()) != 0) {
      return ErrnoStatus(errno, absl::StrCat("cannot write '", CatalogPath(to_), "'"));
    }
    return SyncFolder(to_, {});
  }

  absl::Status RemoveOld(const std::vector<std::string>& ids, BlobStore* to_blobs) {
    const std::unordered_set<std::string> named(ids.begin(), ids.end());
    PLEAT_ASSIGN_OR_RETURN(const std::vector<std::string> files, to_blobs->List());
    for (const std::string& id : files) {
      if (named.contains(id)) continue;
      PLEAT_RETURN_IF_ERROR(to_blobs->Delete(id));
      ++copy_.num_removed;
    }
    return absl::OkStatus();
  }

  const std::string from_, to_;
  std::unique_ptr<Catalog> source_;
  std::string store_id_;
  StoreCopy copy_;
};

absl::Status RequireCatalog(const std::string& folder) {
  std::error_code error;
  if (fs::exists(CatalogPath(folder), error)) return absl::OkStatus();
  return absl::NotFoundError(absl::StrCat("'", folder,
                                          "' has no catalogue.db: it is neither a data "
                                          "folder nor a backup"));
}

}  // namespace

absl::StatusOr<StoreCopy> BackupStore(const std::string& data_dir, const std::string& backup,
                                      const Progress& progress) {
  PLEAT_RETURN_IF_ERROR(RequireCatalog(data_dir));
  return StoreCopier(data_dir, backup).Run(progress);
}

absl::StatusOr<StoreCopy> RestoreStore(const std::string& backup, const std::string& data_dir,
                                       const Progress& progress) {
  PLEAT_RETURN_IF_ERROR(RequireCatalog(backup));
  if (!IsFree(data_dir)) {
    return absl::FailedPreconditionError(absl::StrCat(
        "'", data_dir, "' is not empty; move it away first, so that nothing of it is lost"));
  }
  return StoreCopier(backup, data_dir).Run(progress);
}

}  // namespace pleat
