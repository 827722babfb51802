// The data folder of one server.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "pleat/store/blob_store.h"
#include "pleat/store/catalog.h"
#include "pleat/store/quarantine.h"
#include "pleat/store/sync_hook.h"
#include "pleat/store/upload_area.h"

namespace pleat {

class FileLock;

struct StoreOptions {
  std::string data_dir{};
  uint64_t reserve_bytes = uint64_t{256} << 20;  // kept free on the disk
  // Receives one sentence for the operator about each thing that is not as it should be, such as a
  // file that has changed. Called from any thread.
  std::function<void(const std::string& problem)> on_problem{};
  SyncHook before_sync{};  // for tests
};

// Invariants:
//  - One process at a time uses the folder (DATA/lock).
//  - A sequence, compressed sequence, model or rig exists exactly when it has a row; jobs are rows
//    alone. A row is durable only after its file is: whoever finds a row can read the file.
//  - So the file comes first when an entry is added, and goes last when it is deleted. Add:
//        1. write the content under a temporary name and sync it   (an upload: sync what arrived)
//        2. rename it to DATA/blobs/ab/ab12...
//        3. sync the folders, so that the name is durable
//        4. commit the row
//    and Delete:
//        5. commit the removal of the row
//        6. remove the file
//    A crash after 1 leaves a temporary file or an upload that can go on; a crash after 5 leaves a
//    file that the catalog lists as a pending removal. The next Open removes both. A crash after 2
//    or 3 leaves a file that nobody knows. So a crash at any point means that the change happened
//    or that it did not.
//  - No file is erased but a temporary one and one that somebody asked to delete. A file that no
//    row names, for whatever reason, goes to the quarantine, and so does one whose content has
//    changed. Its entry stays, and the same content uploaded again makes it whole.
//  - Catalog and files have the same store id; Open refuses a catalog that is empty or foreign to
//    the files beside it (store_identity.h). Only a disk that loses synced data makes a row without
//    a file; missing_files() names those.
//
// Locks: step 1 takes seconds for large files and holds nothing. Steps 2 to 4 of one id, and 5 and
// 6, exclude each other (IdLock): else a Delete between 2 and 4 would take the file away under the
// new row. Other ids go on meanwhile, and readers take no lock of the store at all: the catalog
// reads through a connection of its own, and files never change. So no read waits for a sync.
//
// All parts are thread-safe.
class Store {
 public:
  // Makes the folder when it is missing, and ends what a crash interrupted. A full disk is no
  // reason not to open. kFailedPrecondition when another process holds the folder, or when its
  // catalog and its files do not belong together; kDataLoss when the catalog is damaged.
  static absl::StatusOr<std::unique_ptr<Store>> Open(const StoreOptions& options);
  ~Store();
  Store(const Store&) = delete;
  Store& operator=(const Store&) = delete;

  // Stores a file together with its row, durably: `bytes`, whose SHA-256 is entry.id (else
  // kInvalidArgument). An entry that is there already gets the new record. The file is written even
  // if another project has it: how long that takes must not tell.
  absl::Status Add(EntryKind kind, const CatalogEntry& entry, std::string_view bytes);
  // The same with the content of a complete upload (Upload::ReadComplete), which moves.
  absl::Status Add(EntryKind kind, const CatalogEntry& entry, Upload* upload);
  // Makes an entry of a file that is stored for another project; kNotFound when it is not.
  absl::Status AddStored(EntryKind kind, const CatalogEntry& entry);
  // Removes row and file; kNotFound when there is no such row. The file stays while a row of
  // another kind or project names it.
  absl::Status Delete(const ProjectKind& kind, const std::string& id);
  // The same, if the entry is not pinned and its life was over at `now_unix_ms`; else kNotFound.
  absl::Status DeleteExpired(const ProjectKind& kind, const std::string& id, int64_t now_unix_ms);

  // Read returns the content of a file, and Verify reads it and says whether it is intact.
  // kNotFound when it is not there, kDataLoss when it has changed: then it is in quarantine
  // afterwards. kUnavailable when the disk gives an error.
  absl::StatusOr<std::string> Read(const std::string& id);
  absl::Status Verify(const std::string& id);

  // Writes, syncs and removes a file of one byte. The error says why nothing can be stored at the
  // moment: the disk gives errors or is read-only, or its room is used up but for the reserve.
  absl::Status ProbeDisk();

  // Tells the operator (StoreOptions::on_problem).
  void Report(const std::string& problem) const;

  BlobStore& blobs() { return *blobs_; }
  Catalog& catalog() { return *catalog_; }
  // What arrives for a project, apart from what arrives for others: the same content may be on its
  // way for two of them, and neither notices the other. The error of making its folder.
  absl::StatusOr<UploadArea*> uploads(const std::string& project);
  UploadArea& uploads() { return *uploads_; }  // of the default project
  // The projects that something has arrived for.
  std::vector<std::string> UploadProjects() const;
  const Quarantine& quarantine() const { return quarantine_; }

  // Ids of entries whose file was gone when the store was opened.
  const std::vector<std::string>& missing_files() const { return missing_files_; }

 private:
  class IdLock;
  explicit Store(const StoreOptions& options);
  absl::Status Reconcile(const std::string& data_dir);
  absl::Status NoteFileSizes();
  absl::Status SettleIdentity(const std::string& data_dir, size_t num_named, size_t num_files);
  // Call with the IdLock held, or before anybody else can use the store.
  absl::Status RemoveUnnamed(const std::string& id);
  absl::Status QuarantineIfDamaged(const std::string& id);

  const std::string data_dir_;
  const std::function<void(const std::string& problem)> on_problem_;
  Quarantine quarantine_;
  std::unique_ptr<FileLock> lock_;
  std::unique_ptr<BlobStore> blobs_;
  std::unique_ptr<Catalog> catalog_;
  const SyncHook before_sync_;
  std::unique_ptr<UploadArea> uploads_;
  std::mutex projects_mutex_;
  std::map<std::string, std::unique_ptr<UploadArea>>
      project_uploads_;  // guarded by projects_mutex_
  std::vector<std::string> missing_files_;

  std::mutex ids_mutex_;            // never held during a sync
  std::set<std::string> busy_ids_;  // guarded by ids_mutex_; ids that an IdLock holds
  std::condition_variable id_free_;
};

}  // namespace pleat
