// What exists, as rows in SQLite.
#pragma once

#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"

struct sqlite3;

namespace pleat {

enum class EntryKind { kSequence, kModel, kCompressedSequence, kJob, kRig };

struct CatalogueEntry {
  std::string id;
  std::string record;  // the owner's own bytes
  int attempts = 0;    // jobs: how often one was started
};

// Thread-safe: one connection behind one mutex (two SQLite writers would starve each other). Every
// change is on the disk when the call returns (write-ahead log, synchronous=FULL).
class Catalogue {
 public:
  // kFailedPrecondition when a newer version wrote the file, kDataLoss when it is damaged.
  static absl::StatusOr<std::unique_ptr<Catalogue>> Open(const std::string& path);
  ~Catalogue();
  Catalogue(const Catalogue&) = delete;
  Catalogue& operator=(const Catalogue&) = delete;

  // Adds the entry or replaces the one with the same id, which keeps its place in the order.
  absl::Status Put(EntryKind kind, const CatalogueEntry& entry);
  absl::StatusOr<CatalogueEntry> Get(EntryKind kind, const std::string& id);  // or kNotFound
  absl::StatusOr<std::vector<CatalogueEntry>> List(EntryKind kind);           // oldest first
  absl::Status Delete(EntryKind kind, const std::string& id);                 // or kNotFound

 private:
  class Statement;
  explicit Catalogue(sqlite3* database) : database_(database) {}
  absl::Status Execute(const char* sql);
  absl::Status Prepare(const std::string& path);

  std::mutex mutex_;
  sqlite3* database_;  // guarded by mutex_
};

}  // namespace pleat
