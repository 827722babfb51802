#include "pleat/store/store.h"

#include <filesystem>
#include <system_error>
#include <unordered_set>
#include <utility>

#include "absl/strings/str_cat.h"
#include "folder_lock.h"
#include "pleat/base/file.h"
#include "pleat/base/status.h"
#include "store_identity.h"

namespace pleat {
namespace {

std::string ProjectsFolder(const std::string& data_dir) { return data_dir + "/uploads/projects/"; }

CatalogEntry WithSize(CatalogEntry entry, uint64_t file_bytes) {
  entry.file_bytes = file_bytes;
  return entry;
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

Store::Store(const StoreOptions& options)
    : data_dir_(options.data_dir),
      on_problem_(options.on_problem),
      quarantine_(options.data_dir + "/quarantine", options.before_sync),
      before_sync_(options.before_sync) {}

absl::StatusOr<std::unique_ptr<Store>> Store::Open(const StoreOptions& options) {
  const std::string& data_dir = options.data_dir;
  if (data_dir.empty()) return absl::InvalidArgumentError("the data folder has no name");
  std::error_code error;
  if (std::filesystem::create_directories(data_dir, error)) {
    std::filesystem::permissions(data_dir, std::filesystem::perms::owner_all, error);
  }
  if (error) {
    return ErrnoStatus(error.value(), absl::StrCat("cannot create '", data_dir, "'"));
  }
  std::unique_ptr<Store> store(new Store(options));
  PLEAT_ASSIGN_OR_RETURN(FileLock lock, LockFolder(data_dir));
  store->lock_ = std::make_unique<FileLock>(std::move(lock));
  PLEAT_ASSIGN_OR_RETURN(
      BlobStore blobs,
      BlobStore::Open(data_dir + "/blobs", options.reserve_bytes, options.before_sync));
  store->blobs_ = std::make_unique<BlobStore>(std::move(blobs));
  PLEAT_ASSIGN_OR_RETURN(store->catalog_,
                         Catalog::Open(CatalogPath(data_dir), options.before_sync));
  PLEAT_ASSIGN_OR_RETURN(store->uploads_,
                         UploadArea::Open(data_dir + "/uploads", options.before_sync));
  PLEAT_RETURN_IF_ERROR(store->Reconcile(data_dir));
  if (const auto room = store->blobs_->ReserveSpace(0); !room.ok()) {
    store->Report(absl::StrCat("nothing can be uploaded: ", std::string(room.status().message())));
  }
  return store;
}

Store::~Store() {
  catalog_.reset();  // before the lock goes
}

void Store::Report(const std::string& problem) const {
  if (on_problem_) on_problem_(problem);
}

absl::Status Store::ProbeDisk() {
  PLEAT_RETURN_IF_ERROR(blobs_->ReserveSpace(1).status());
  // The path stays out of the message, which clients may see.
  const std::string path = data_dir_ + "/probe";
  const absl::Status status = WriteFile(path, "?");
  std::error_code error;
  std::filesystem::remove(path, error);
  if (status.ok()) return status;
  return absl::UnavailableError("nothing can be written to the server's disk");
}

absl::Status Store::Add(EntryKind kind, const CatalogEntry& entry, std::string_view bytes) {
  while (true) {
    const bool is_known = catalog_->Get({kind, entry.project}, entry.id).ok();
    PLEAT_ASSIGN_OR_RETURN(
        StagedFile file,
        blobs_->Stage(bytes, is_known ? BlobStore::IfThere::kKeep : BlobStore::IfThere::kReplace));
    if (file.id() != entry.id) {
      return absl::InvalidArgumentError(absl::StrCat("a file with the SHA-256 ", file.id(),
                                                     " cannot be stored as '", entry.id, "'"));
    }
    const IdLock lock(this, entry.id);
    // Deleted between Stage and the lock: write it after all.
    if (file.already_stored() && !blobs_->Contains(entry.id)) continue;
    PLEAT_RETURN_IF_ERROR(blobs_->Publish(std::move(file)));
    return catalog_->Put(kind, WithSize(entry, bytes.size()));
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
  return catalog_->Put(kind, WithSize(entry, upload->size_bytes()));
}

absl::Status Store::AddStored(EntryKind kind, const CatalogEntry& entry) {
  const IdLock lock(this, entry.id);
  PLEAT_ASSIGN_OR_RETURN(const uint64_t size, blobs_->Size(entry.id));
  return catalog_->Put(kind, WithSize(entry, size));
}

absl::StatusOr<UploadArea*> Store::uploads(const std::string& project) {
  if (project == kDefaultProject) return uploads_.get();
  std::lock_guard lock(projects_mutex_);
  std::unique_ptr<UploadArea>& area = project_uploads_[project];
  if (area == nullptr) {
    PLEAT_RETURN_IF_ERROR(CheckProjectName(project));
    PLEAT_ASSIGN_OR_RETURN(area,
                           UploadArea::Open(ProjectsFolder(data_dir_) + project, before_sync_));
  }
  return area.get();
}

std::vector<std::string> Store::UploadProjects() const {
  std::vector<std::string> projects = {kDefaultProject};
  std::error_code error;
  const std::filesystem::directory_iterator folder(ProjectsFolder(data_dir_), error);
  if (error) return projects;
  for (const auto& entry : folder) {
    const std::string name = entry.path().filename();
    if (CheckProjectName(name).ok()) projects.push_back(name);
  }
  return projects;
}

absl::Status Store::Delete(const ProjectKind& kind, const std::string& id) {
  const IdLock lock(this, id);
  PLEAT_RETURN_IF_ERROR(catalog_->Delete(kind, id));
  return RemoveUnnamed(id);
}

absl::Status Store::DeleteExpired(const ProjectKind& kind, const std::string& id,
                                  int64_t now_unix_ms) {
  const IdLock lock(this, id);
  PLEAT_RETURN_IF_ERROR(catalog_->DeleteExpired(kind, id, now_unix_ms));
  return RemoveUnnamed(id);
}

absl::Status Store::RemoveUnnamed(const std::string& id) {
  PLEAT_ASSIGN_OR_RETURN(const bool is_named, catalog_->NamesFile(id));
  if (!is_named) PLEAT_RETURN_IF_ERROR(blobs_->Delete(id));
  return catalog_->ForgetRemoval(id);
}

absl::StatusOr<std::string> Store::Read(const std::string& id) {
  absl::StatusOr<std::string> bytes = blobs_->Get(id);
  if (absl::IsDataLoss(bytes.status())) QuarantineIfDamaged(id).IgnoreError();
  return bytes;
}

absl::Status Store::Verify(const std::string& id) {
  absl::Status status = blobs_->Verify(id);
  if (absl::IsDataLoss(status)) QuarantineIfDamaged(id).IgnoreError();
  return status;
}

// Looks again under the lock: meanwhile a new upload may have put an intact file there.
absl::Status Store::QuarantineIfDamaged(const std::string& id) {
  const IdLock lock(this, id);
  const absl::Status found = blobs_->Verify(id);
  if (!absl::IsDataLoss(found)) return found;
  const absl::Status moved = quarantine_.Take(blobs_->PathOf(id), "its content has changed");
  Report(absl::StrCat("the file '", id, "' has changed on the disk",
                      moved.ok() ? " and is in quarantine now; upload it again or restore it"
                                 : absl::StrCat(" and could not be moved to the quarantine: ",
                                                std::string(moved.message()))));
  return moved;
}

absl::Status Store::Reconcile(const std::string& data_dir) {
  PLEAT_ASSIGN_OR_RETURN(const std::vector<std::string> named, catalog_->FileIds());
  PLEAT_ASSIGN_OR_RETURN(const std::vector<std::string> files, blobs_->List());
  const std::unordered_set<std::string> there(files.begin(), files.end());
  for (const std::string& id : named) {
    if (!there.contains(id)) missing_files_.push_back(id);
  }
  PLEAT_RETURN_IF_ERROR(SettleIdentity(data_dir, named.size(), files.size()));
  PLEAT_RETURN_IF_ERROR(NoteFileSizes());
  for (const std::string& id : missing_files_) {
    Report(absl::StrCat("the file of '", id, "' is gone; upload it again, restore or delete it"));
  }
  PLEAT_ASSIGN_OR_RETURN(const std::vector<std::string> removals, catalog_->PendingRemovals());
  for (const std::string& id : removals) {
    if (const absl::Status status = RemoveUnnamed(id); !status.ok()) {
      Report(absl::StrCat("the file of the deleted entry '", id,
                          "' cannot be removed: ", std::string(status.message())));
    }
  }
  const std::unordered_set<std::string> removed(removals.begin(), removals.end());
  const std::unordered_set<std::string> known(named.begin(), named.end());
  size_t num_unknown = 0;
  absl::Status moved;
  for (const std::string& id : files) {
    if (known.contains(id) || removed.contains(id)) continue;
    ++num_unknown;
    moved.Update(quarantine_.Take(blobs_->PathOf(id), "no entry names it"));
  }
  if (num_unknown > 0) {
    Report(absl::StrCat("files that no entry names: ", num_unknown,
                        moved.ok() ? " moved to the quarantine" : " left where they are",
                        "; 'pleat store check' lists them",
                        moved.ok() ? "" : absl::StrCat(" (", std::string(moved.message()), ")")));
  }
  return absl::OkStatus();
}

// Rows of older versions do not know how large their files are. A file that is gone counts nothing.
absl::Status Store::NoteFileSizes() {
  PLEAT_ASSIGN_OR_RETURN(const std::vector<std::string> ids, catalog_->FilesWithoutSize());
  for (const std::string& id : ids) {
    const absl::StatusOr<uint64_t> size = blobs_->Size(id);
    // A full disk is no reason not to start.
    if (size.ok() && *size > 0) catalog_->NoteFileSize(id, *size).IgnoreError();
  }
  return absl::OkStatus();
}

absl::Status Store::SettleIdentity(const std::string& data_dir, size_t num_named,
                                   size_t num_files) {
  StoreSides sides{.num_named = num_named,
                   .num_files = num_files,
                   .num_common = num_named - missing_files_.size()};
  PLEAT_ASSIGN_OR_RETURN(sides.catalog_id, catalog_->StoreId());
  PLEAT_ASSIGN_OR_RETURN(sides.blobs_id, ReadBlobsId(blobs_->folder()));
  PLEAT_ASSIGN_OR_RETURN(std::string id, AgreeOnStoreId(sides, data_dir));
  if (id.empty()) id = MakeStoreId();
  // Files first: a crash in between leaves a side without an id, and the next start agrees again.
  if (sides.blobs_id != id) PLEAT_RETURN_IF_ERROR(WriteBlobsId(blobs_->folder(), id));
  if (sides.catalog_id != id) PLEAT_RETURN_IF_ERROR(catalog_->SetStoreId(id));
  return absl::OkStatus();
}

}  // namespace pleat
