// Stored files and their rows in the catalog, as all services of this process keep them.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "pleat/base/memory_budget.h"
#include "pleat/base/progress.h"
#include "pleat/base/wall_clock.h"
#include "pleat/service/content_download.h"
#include "pleat/service/content_upload.h"
#include "pleat/service/entry_life.h"
#include "pleat/service/limits.h"
#include "pleat/store/store.h"

namespace pleat {

// The store together with the limits of the service. Thread-safe.
class StoredFiles {
 public:
  // upload_memory: what checking uploads may take together, shared with others; null: not counted.
  StoredFiles(std::unique_ptr<Store> store, const ServiceLimits& limits,
              WallClock clock = SystemTime, MemoryBudget* upload_memory = nullptr)
      : store_(std::move(store)),
        limits_(limits),
        clock_(std::move(clock)),
        upload_memory_(upload_memory) {}

  Catalog& catalog() { return store_->catalog(); }
  UploadArea& uploads() { return store_->uploads(); }
  Store& store() const { return *store_; }
  const std::vector<std::string>& missing_files() const { return store_->missing_files(); }
  const ServiceLimits& limits() const { return limits_; }

  const WallClock& clock() const { return clock_; }

  // A file and its row appear and disappear together (see Store). An entry that is new is created
  // now. ttl: how long it is kept at least; the longest life of an entry counts.
  absl::Status Add(EntryKind kind, const CatalogEntry& entry, std::string_view bytes,
                   absl::Duration ttl = kKeepForEver) {
    return store_->Add(kind, BornNow(entry, ttl), bytes);
  }
  absl::Status Add(EntryKind kind, const CatalogEntry& entry, Upload* upload,
                   absl::Duration ttl = kKeepForEver) {
    return store_->Add(kind, BornNow(entry, ttl), upload);
  }
  // Keeps an entry so long from now on, if not longer. kNotFound when there is none.
  absl::Status Prolong(EntryKind kind, const std::string& id, absl::Duration ttl) {
    return catalog().Prolong(kind, id, ExpiryOf(clock_(), ttl));
  }
  absl::Status Delete(EntryKind kind, const std::string& id) { return store_->Delete(kind, id); }
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
  // Gives the right to write an upload from `offset_bytes` on. kResourceExhausted when the declared
  // size exceeds the limits or the disk, kOutOfRange when the offset is beyond the size.
  absl::StatusOr<std::unique_ptr<Upload>> BeginUpload(const std::string& id, uint64_t size_bytes,
                                                      uint64_t offset_bytes);
  // Memory for the check of a complete upload. When there is none at the moment, what has arrived
  // stays, and the client need only ask for the check again.
  absl::StatusOr<Reservation> ReserveForUpload(uint64_t bytes) {
    if (upload_memory_ == nullptr) return Reservation();
    return upload_memory_->Reserve(bytes, "checking the upload");
  }

 private:
  static int64_t ExpiryOf(absl::Time now, absl::Duration ttl);  // as the catalog writes it
  CatalogEntry BornNow(CatalogEntry entry, absl::Duration ttl) const;

  const std::unique_ptr<Store> store_;
  const ServiceLimits limits_;
  const WallClock clock_;
  MemoryBudget* const upload_memory_;
  std::mutex mutex_;
  std::set<std::string> bad_rows_;  // that were reported; guarded by mutex_
};

// An upload into the store. `finish` checks the complete bytes and adds them to the catalog.
template <typename Info>
class StoredUpload final : public ContentUpload<Info> {
 public:
  using FinishUpload = std::function<absl::StatusOr<Info>(Upload*)>;
  StoredUpload(std::unique_ptr<Upload> upload, FinishUpload finish)
      : upload_(std::move(upload)), finish_(std::move(finish)) {}

  absl::Status Append(std::string_view bytes) override { return upload_->Append(bytes); }
  uint64_t received_bytes() const override { return upload_->received_bytes(); }
  absl::StatusOr<Info> Finish() override { return finish_(upload_.get()); }

 private:
  const std::unique_ptr<Upload> upload_;
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
