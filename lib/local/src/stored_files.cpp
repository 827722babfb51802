#include "pleat/local/stored_files.h"

#include <utility>

#include "absl/strings/str_cat.h"
#include "pleat/base/status.h"

namespace pleat {
namespace {

constexpr uint64_t kDownloadStepBytes = 8 << 20;

}  // namespace

void StoredFiles::ReportBadRow(EntryKind kind, const std::string& id, const absl::Status& why) {
  {
    std::lock_guard lock(mutex_);
    if (!bad_rows_.insert(id).second) return;
  }
  store_->Report(absl::StrCat("the row of the ", EntryKindName(kind), " '", id,
                              "' cannot be read and is left out: ", std::string(why.message())));
}

absl::StatusOr<std::string> StoredFiles::ReadBytes(EntryKind kind, const std::string& id,
                                                   uint64_t offset, uint64_t count) {
  PLEAT_RETURN_IF_ERROR(catalog().Get(kind, id).status());
  if (offset == 0) PLEAT_RETURN_IF_ERROR(store_->Verify(id));
  return store_->blobs().GetRange(id, offset, count);
}

absl::StatusOr<std::string> StoredFiles::Download(EntryKind kind, const std::string& id,
                                                  uint64_t size_bytes, const Progress& progress) {
  std::string bytes;
  while (bytes.size() < size_bytes) {
    PLEAT_ASSIGN_OR_RETURN(const std::string part,
                           ReadBytes(kind, id, bytes.size(), kDownloadStepBytes));
    if (part.empty()) return absl::DataLossError(absl::StrCat("the file '", id, "' is cut off"));
    bytes += part;
    PLEAT_RETURN_IF_ERROR(progress.Report(static_cast<double>(bytes.size()) / size_bytes));
  }
  return bytes;
}

absl::StatusOr<std::unique_ptr<Upload>> StoredFiles::BeginUpload(const std::string& id,
                                                                 uint64_t size_bytes,
                                                                 uint64_t offset_bytes) {
  if (size_bytes == 0) return absl::InvalidArgumentError("an upload of 0 bytes is nothing to keep");
  if (size_bytes > static_cast<uint64_t>(limits_.max_upload_bytes)) {
    return absl::ResourceExhaustedError(absl::StrCat("the upload has ", size_bytes,
                                                     " bytes, the limit (--max-upload-bytes) is ",
                                                     limits_.max_upload_bytes));
  }
  if (offset_bytes > size_bytes) {
    return absl::OutOfRangeError(absl::StrCat(
        "offset ", offset_bytes, " is behind the end of an upload of ", size_bytes, " bytes"));
  }
  PLEAT_ASSIGN_OR_RETURN(SpaceReservation room,
                         store_->blobs().ReserveSpace(size_bytes - offset_bytes));
  return uploads().Begin(id, size_bytes, offset_bytes, std::move(room));
}

}  // namespace pleat
