#include "pleat/local/stored_files.h"

#include <algorithm>
#include <utility>

#include "absl/strings/str_cat.h"
#include "pleat/base/limit_refusal.h"
#include "pleat/base/status.h"

namespace pleat {
namespace {

// Somebody has to delete something first.
constexpr absl::Duration kRetryAfter = absl::Minutes(5);

class StoredDownload final : public ContentDownload {
 public:
  StoredDownload(std::unique_ptr<OpenFile> file, uint64_t offset_bytes)
      : file_(std::move(file)), offset_bytes_(offset_bytes) {}

  uint64_t size_bytes() const override { return file_->size_bytes(); }
  absl::StatusOr<std::string> Next() override {
    PLEAT_ASSIGN_OR_RETURN(std::string bytes, file_->Read(offset_bytes_, kDownloadPieceBytes));
    offset_bytes_ += bytes.size();
    return bytes;
  }

 private:
  const std::unique_ptr<OpenFile> file_;
  uint64_t offset_bytes_;
};

}  // namespace

StoredFiles::StoredFiles(std::shared_ptr<Store> store, const ServiceLimits& limits, WallClock clock,
                         StoredFilesOptions options)
    : store_(std::move(store)),
      limits_(limits),
      clock_(std::move(clock)),
      options_(std::move(options)),
      catalog_(&store_->catalog(), options_.project),
      room_(options_.max_bytes == 0
                ? nullptr
                : std::make_shared<DiskSpace>([this] { return FreeBytes(); }, 0)) {}

absl::StatusOr<uint64_t> StoredFiles::FreeBytes() {
  PLEAT_ASSIGN_OR_RETURN(const uint64_t stored, catalog_.FileBytes());
  PLEAT_ASSIGN_OR_RETURN(UploadArea* const arriving, uploads());
  const uint64_t used = stored + arriving->TotalBytes();
  return options_.max_bytes - std::min(options_.max_bytes, used);
}

absl::StatusOr<SpaceReservation> StoredFiles::ReserveRoom(uint64_t bytes) {
  if (room_ == nullptr) return SpaceReservation();
  absl::StatusOr<SpaceReservation> room = room_->Reserve(bytes);
  if (!absl::IsResourceExhausted(room.status())) return room;
  LimitRefusal refusal{.subject = absl::StrCat("project:", options_.project),
                       .limit = "--project-bytes"};
  if (bytes <= options_.max_bytes) refusal.retry_after = kRetryAfter;
  return RefuseForLimit(
      refusal, absl::StrCat("the project '", options_.project, "' may store ", options_.max_bytes,
                            " bytes (--project-bytes) and has no room for ", bytes,
                            " more; delete sequences or models, or give uploads up"));
}

std::optional<CatalogEntry> StoredFiles::FindShared(EntryKind kind, const std::string& id) {
  if (!options_.share_content) return std::nullopt;
  absl::StatusOr<CatalogEntry> entry = store_->catalog().GetInAnyProject(kind, id);
  if (!entry.ok() || !IsIntact(id)) return std::nullopt;
  return *std::move(entry);
}

absl::Status StoredFiles::TakeShared(EntryKind kind, const CatalogEntry& shared,
                                     absl::Duration ttl) {
  PLEAT_ASSIGN_OR_RETURN(const SpaceReservation room, ReserveRoom(shared.file_bytes));
  CatalogEntry entry{.id = shared.id, .record = shared.record};
  entry.file_bytes = shared.file_bytes;
  return store_->AddStored(kind, Born(std::move(entry), ttl));
}

int64_t StoredFiles::ExpiryOf(absl::Time now, absl::Duration ttl) {
  if (ttl == kKeepForEver) return 0;
  return std::max<int64_t>(1, absl::ToUnixMillis(now + ttl));
}

CatalogEntry StoredFiles::Born(CatalogEntry entry, absl::Duration ttl) const {
  entry.project = options_.project;
  // Whole milliseconds, as they are kept: so the difference of the two is the time to live.
  entry.created_unix_ms = absl::ToUnixMillis(clock_());
  entry.expires_unix_ms = ExpiryOf(absl::FromUnixMillis(entry.created_unix_ms), ttl);
  return entry;
}

void StoredFiles::ReportBadRow(EntryKind kind, const std::string& id, const absl::Status& why) {
  {
    std::lock_guard lock(mutex_);
    if (!bad_rows_.insert(id).second) return;
  }
  store_->Report(absl::StrCat("the row of the ", EntryKindName(kind), " '", id,
                              "' cannot be read and is left out: ", std::string(why.message())));
}

absl::StatusOr<std::unique_ptr<ContentDownload>> StoredFiles::OpenDownload(EntryKind kind,
                                                                           const std::string& id,
                                                                           uint64_t offset_bytes) {
  PLEAT_RETURN_IF_ERROR(catalog().Get(kind, id).status());
  if (offset_bytes == 0) PLEAT_RETURN_IF_ERROR(store_->Verify(id));
  PLEAT_ASSIGN_OR_RETURN(std::unique_ptr<OpenFile> file, store_->blobs().OpenForReading(id));
  PLEAT_RETURN_IF_ERROR(file->Read(offset_bytes, 0).status());  // the offset is within the file
  return std::make_unique<StoredDownload>(std::move(file), offset_bytes);
}

absl::StatusOr<std::string> StoredFiles::Download(EntryKind kind, const std::string& id,
                                                  uint64_t size_bytes, const Progress& progress) {
  PLEAT_ASSIGN_OR_RETURN(const std::unique_ptr<ContentDownload> download,
                         OpenDownload(kind, id, 0));
  std::string bytes;
  while (bytes.size() < size_bytes) {
    PLEAT_ASSIGN_OR_RETURN(const std::string part, download->Next());
    if (part.empty()) return absl::DataLossError(absl::StrCat("the file '", id, "' is cut off"));
    bytes += part;
    PLEAT_RETURN_IF_ERROR(progress.Report(static_cast<double>(bytes.size()) / size_bytes));
  }
  return bytes;
}

absl::StatusOr<StoredFiles::BegunUpload> StoredFiles::BeginUpload(const std::string& id,
                                                                  uint64_t size_bytes,
                                                                  uint64_t offset_bytes) {
  if (size_bytes == 0) return absl::InvalidArgumentError("an upload of 0 bytes is nothing to keep");
  if (size_bytes > static_cast<uint64_t>(limits_.max_upload_bytes)) {
    return RefuseForLimit(
        {.limit = "--max-upload-bytes"},
        absl::StrCat("the upload has ", size_bytes, " bytes, the limit (--max-upload-bytes) is ",
                     limits_.max_upload_bytes));
  }
  if (offset_bytes > size_bytes) {
    return absl::OutOfRangeError(absl::StrCat(
        "offset ", offset_bytes, " is behind the end of an upload of ", size_bytes, " bytes"));
  }
  PLEAT_ASSIGN_OR_RETURN(SpaceReservation room, ReserveRoom(size_bytes - offset_bytes));
  PLEAT_ASSIGN_OR_RETURN(SpaceReservation disk,
                         store_->blobs().ReserveSpace(size_bytes - offset_bytes));
  PLEAT_ASSIGN_OR_RETURN(UploadArea* const area, uploads());
  PLEAT_ASSIGN_OR_RETURN(std::unique_ptr<Upload> upload,
                         area->Begin(id, size_bytes, offset_bytes, std::move(disk)));
  return BegunUpload{std::move(upload), std::move(room)};
}

}  // namespace pleat
