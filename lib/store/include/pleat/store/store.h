// The data folder of one server.
#pragma once

#include <condition_variable>
#include <cstdint>
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
#include "pleat/store/sync_hook.h"
#include "pleat/store/upload_area.h"

namespace pleat {

struct StoreOptions {
  std::string data_dir{};
  uint64_t reserve_bytes = uint64_t{256} << 20;  // kept free on the disk
  SyncHook before_sync{};                        // for tests
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
//    A crash after 1 leaves a temporary file or an upload that can go on; a crash after 2, 3 or 5
//    leaves a file without a row. The next Open removes both kinds of leftovers, so a crash at any
//    point means that the change happened or that it did not. Only a disk that loses synced data
//    makes a row without a file; missing_files() names those.
//
// Locks: step 1 takes seconds for large files and holds nothing. Steps 2 to 4 of one id, and 5 and
// 6, exclude each other (IdLock): else a Delete between 2 and 4 would take the file away under the
// new row. Other ids go on meanwhile, and readers take no lock of the store at all: the catalog
// reads through a connection of its own, and files never change. So no read waits for a sync.
//
// All parts are thread-safe.
class Store {
 public:
  // Makes the folder when it is missing and removes what a crash left behind.
  // kFailedPrecondition when another process holds it.
  static absl::StatusOr<std::unique_ptr<Store>> Open(const StoreOptions& options);
  ~Store();
  Store(const Store&) = delete;
  Store& operator=(const Store&) = delete;

  // Stores a file together with its row, durably: `bytes`, whose SHA-256 is entry.id (else
  // kInvalidArgument). An entry that is there already gets the new record.
  absl::Status Add(EntryKind kind, const CatalogEntry& entry, std::string_view bytes);
  // The same with the content of a complete upload (Upload::ReadComplete), which moves.
  absl::Status Add(EntryKind kind, const CatalogEntry& entry, Upload* upload);
  // Removes row and file; kNotFound when there is no such row.
  absl::Status Delete(EntryKind kind, const std::string& id);

  BlobStore& blobs() { return *blobs_; }
  Catalog& catalog() { return *catalog_; }
  UploadArea& uploads() { return *uploads_; }

  // Ids of sequences, models and rigs whose file was gone when the store was opened.
  const std::vector<std::string>& missing_files() const { return missing_files_; }

 private:
  class IdLock;
  Store() = default;
  absl::Status Clean();

  int lock_fd_ = -1;
  std::unique_ptr<BlobStore> blobs_;
  std::unique_ptr<Catalog> catalog_;
  std::unique_ptr<UploadArea> uploads_;
  std::vector<std::string> missing_files_;

  std::mutex ids_mutex_;            // never held during a sync
  std::set<std::string> busy_ids_;  // guarded by ids_mutex_; ids that an IdLock holds
  std::condition_variable id_free_;
};

}  // namespace pleat
