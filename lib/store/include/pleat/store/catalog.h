// What exists, as rows of a SQLite database.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "pleat/store/sync_hook.h"

namespace pleat {

class SyncHookVfs;

enum class EntryKind { kSequence, kModel, kCompressedSequence, kJob, kRig };

struct CatalogEntry {
  std::string id;
  std::string record;  // the owner's own bytes
  int attempts = 0;    // jobs: how often one was started
};

// Invariants:
//  - The file is a SQLite database in write-ahead-log mode with one table, `entries`; its version
//    is PRAGMA user_version. `record` is opaque here: records.h says what it holds.
//  - An entry is (kind, id). Its position, the order in which entries were added, never changes.
//  - A call that changes something returns after its commit has been synced (synchronous=FULL):
//    what was reported survives a power cut. A crash before that loses the whole change, never a
//    part.
//  - Nobody sees a change before it is durable: SQLite publishes a commit to readers after the
//    sync.
//
// Threads: two connections, each behind its own mutex. All changes go through `writer_`, one at a
// time, because SQLite has one writer anyway and two connections that write would starve each
// other; its mutex is held during the sync. All reads go through `reader_`, which sees the last
// commit and in write-ahead-log mode waits for no writer. So a read never waits for a sync, and a
// thread that reads after its own write returned sees that write. Neither mutex is held while the
// other is taken. Thread-safe.
class Catalog {
 public:
  // kFailedPrecondition when a newer version wrote the file, kDataLoss when it is damaged.
  static absl::StatusOr<std::unique_ptr<Catalog>> Open(const std::string& path,
                                                       SyncHook before_sync = {});
  ~Catalog();
  Catalog(const Catalog&) = delete;
  Catalog& operator=(const Catalog&) = delete;

  // Adds the entry or replaces the one with the same id, which keeps its place in the order.
  absl::Status Put(EntryKind kind, const CatalogEntry& entry);
  absl::StatusOr<CatalogEntry> Get(EntryKind kind, const std::string& id);  // or kNotFound
  absl::StatusOr<std::vector<CatalogEntry>> List(EntryKind kind);           // oldest first
  absl::Status Delete(EntryKind kind, const std::string& id);               // or kNotFound

 private:
  class Connection;
  class Statement;
  Catalog();
  absl::Status Prepare(const std::string& path);

  std::unique_ptr<SyncHookVfs> vfs_;  // null without a hook; outlives the connections
  std::unique_ptr<Connection> writer_;
  std::unique_ptr<Connection> reader_;
};

}  // namespace pleat
