// Stored files of a project and their rows in the catalog, as all services of this process keep
// them.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "pleat/base/memory_budget.h"
#include "pleat/base/progress.h"
#include "pleat/base/project.h"
#include "pleat/base/status.h"
#include "pleat/base/wall_clock.h"
#include "pleat/service/content_download.h"
#include "pleat/service/content_upload.h"
#include "pleat/service/entry_life.h"
#include "pleat/service/limits.h"
#include "pleat/store/project_catalog.h"
#include "pleat/store/store.h"

namespace pleat {

struct StoredFilesOptions {
  std::string project = kDefaultProject;
  // Uploads of content that another project has end at once. Without it, they behave exactly like
  // those of content that nobody has.
  bool share_content = false;
  uint64_t max_bytes = 0;  // that the project may store; 0: no limit
  // What checking uploads may take together, shared with others; null: not counted.
  MemoryBudget* upload_memory = nullptr;
};

// The files of one project in the store, together with the limits of the service. Thread-safe.
class StoredFiles {
 public:
  StoredFiles(std::shared_ptr<Store> store, const ServiceLimits& limits,
              WallClock clock = SystemTime, StoredFilesOptions options = {});

  // The rows of the project. Rows of others can only be reached through the store itself, which is
  // for retention, the scrubber and the jobs of all projects.
  ProjectCatalog& catalog() { return catalog_; }
  const std::string& project() const { return options_.project; }
  absl::StatusOr<UploadArea*> uploads() { return store_->uploads(options_.project); }
  Store& store() const { return *store_; }
  const ServiceLimits& limits() const { return limits_; }

  const WallClock& clock() const { return clock_; }

  // A file and its row appear and disappear together (see Store). An entry that is new is created
  // now. ttl: how long it is kept at least; the longest life of an entry counts.
  absl::Status Add(EntryKind kind, const CatalogEntry& entry, std::string_view bytes,
                   absl::Duration ttl = kKeepForEver) {
    return store_->Add(kind, Born(entry, ttl), bytes);
  }
  absl::Status Add(EntryKind kind, const CatalogEntry& entry, Upload* upload,
                   absl::Duration ttl = kKeepForEver) {
    return store_->Add(kind, Born(entry, ttl), upload);
  }
  // Keeps an entry so long from now on, if not longer. kNotFound when there is none.
  absl::Status Prolong(EntryKind kind, const std::string& id, absl::Duration ttl) {
    return catalog().Prolong(kind, id, ExpiryOf(clock_(), ttl));
  }
  absl::Status Delete(EntryKind kind, const std::string& id) {
    return store_->Delete({kind, options_.project}, id);
  }
  // Returns the content of a stored file, verified (see Store).
  absl::StatusOr<std::string> Read(const std::string& id) { return store_->Read(id); }
  // Says whether the file of an entry is there and intact. It reads the whole file.
  bool IsIntact(const std::string& id) { return store_->Verify(id).ok(); }
  // Tells the operator about an entry whose row cannot be read, once for each.
  void ReportBadRow(EntryKind kind, const std::string& id, const absl::Status& why);

  // Opens the file of an entry from `offset_bytes` on. A download from the start verifies the whole
  // file first. kNotFound when there is no such entry, kDataLoss when its file has changed,
  // kOutOfRange when the offset is behind its end.
  absl::StatusOr<std::unique_ptr<ContentDownload>> OpenDownload(EntryKind kind,
                                                                const std::string& id,
                                                                uint64_t offset_bytes);
  // Returns the whole file, which has `size_bytes`. kDataLoss when the file is shorter.
  absl::StatusOr<std::string> Download(EntryKind kind, const std::string& id, uint64_t size_bytes,
                                       const Progress& progress);
  // The right to write an upload, and room for the rest of it among what the project may store.
  struct BegunUpload {
    std::unique_ptr<Upload> upload;
    SpaceReservation room;
  };
  // Gives it from `offset_bytes` on. kResourceExhausted when the declared size exceeds the limits,
  // what the project may store, or the disk; kOutOfRange when the offset is beyond the size.
  absl::StatusOr<BegunUpload> BeginUpload(const std::string& id, uint64_t size_bytes,
                                          uint64_t offset_bytes);
  // Memory for the check of a complete upload. When there is none at the moment, what has arrived
  // stays, and the client need only ask for the check again.
  absl::StatusOr<Reservation> ReserveForUpload(uint64_t bytes) {
    if (options_.upload_memory == nullptr) return Reservation();
    return options_.upload_memory->Reserve(bytes, "checking the upload");
  }
  // Room for `bytes` among what the project may store; kResourceExhausted.
  absl::StatusOr<SpaceReservation> ReserveRoom(uint64_t bytes);

  // Where content is shared: the entry of another project, whose file is intact. Null where it is
  // not shared or nobody has it.
  std::optional<CatalogEntry> FindShared(EntryKind kind, const std::string& id);
  // Makes such an entry one of this project too.
  absl::Status TakeShared(EntryKind kind, const CatalogEntry& shared, absl::Duration ttl);

 private:
  static int64_t ExpiryOf(absl::Time now, absl::Duration ttl);  // as the catalog writes it
  // The entry as one of this project that is created now.
  CatalogEntry Born(CatalogEntry entry, absl::Duration ttl) const;
  absl::StatusOr<uint64_t> FreeBytes();  // of what the project may store

  const std::shared_ptr<Store> store_;
  const ServiceLimits limits_;
  const WallClock clock_;
  const StoredFilesOptions options_;
  ProjectCatalog catalog_;
  const std::shared_ptr<DiskSpace> room_;  // null: no limit
  std::mutex mutex_;
  std::set<std::string> bad_rows_;  // that were reported; guarded by mutex_
};

// An upload into the store. `finish` checks the complete bytes and adds them to the catalog.
template <typename Info>
class StoredUpload final : public ContentUpload<Info> {
 public:
  using FinishUpload = std::function<absl::StatusOr<Info>(Upload*)>;
  StoredUpload(StoredFiles::BegunUpload begun, FinishUpload finish)
      : upload_(std::move(begun.upload)),
        room_(std::move(begun.room)),
        finish_(std::move(finish)) {}

  absl::Status Append(std::string_view bytes) override {
    PLEAT_RETURN_IF_ERROR(upload_->Append(bytes));
    room_.Spend(bytes.size());  // from now on what has arrived is counted itself
    return absl::OkStatus();
  }
  uint64_t received_bytes() const override { return upload_->received_bytes(); }
  absl::StatusOr<Info> Finish() override { return finish_(upload_.get()); }

 private:
  const std::unique_ptr<Upload> upload_;
  SpaceReservation room_;
  const FinishUpload finish_;
};

// The upload of a file that is stored already.
template <typename Info>
class KnownUpload final : public ContentUpload<Info> {
 public:
  explicit KnownUpload(Info info) : info_(std::move(info)) {}

  bool complete() const override { return true; }
  absl::Status Append(std::string_view) override { return absl::OkStatus(); }
  uint64_t received_bytes() const override { return info_.size_bytes; }
  absl::StatusOr<Info> Finish() override { return info_; }

 private:
  const Info info_;
};

}  // namespace pleat
