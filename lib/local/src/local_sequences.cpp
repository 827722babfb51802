#include "pleat/local/local_sequences.h"

#include <utility>

#include "absl/strings/str_cat.h"
#include "infos.h"
#include "pleat/base/limit_refusal.h"
#include "pleat/base/status.h"
#include "pleat/formats/sequence_file.h"
#include "pleat/service/file_limits.h"
#include "stored_infos.h"

namespace pleat {
namespace {

// What checking a sequence takes at most, in sizes of its file: the bytes, the frames out of them,
// and room for what the allocator keeps of the upload before.
constexpr uint64_t kCheckFactor = 3;

}  // namespace

absl::Status LocalSequences::Check(const MeshSequence& sequence) const {
  const ServiceLimits& limits = files_->limits();
  if (sequence.num_vertices() > limits.max_vertices) {
    return RefuseForLimit(
        {.limit = "--max-vertices"},
        absl::StrCat("the sequence has ", sequence.num_vertices(),
                     " vertices, the limit (--max-vertices) is ", limits.max_vertices));
  }
  if (sequence.num_frames() > limits.max_frames) {
    return RefuseForLimit({.limit = "--max-frames"},
                          absl::StrCat("the sequence has ", sequence.num_frames(),
                                       " frames, the limit (--max-frames) is ", limits.max_frames));
  }
  return absl::OkStatus();
}

absl::StatusOr<SequenceInfo> LocalSequences::Upload(const MeshSequence& sequence,
                                                    const Progress& progress, absl::Duration ttl) {
  PLEAT_RETURN_IF_ERROR(Check(sequence));
  const std::string bytes = EncodeSequence(sequence);
  if (bytes.size() > static_cast<uint64_t>(files_->limits().max_upload_bytes)) {
    return RefuseForLimit({.limit = "--max-upload-bytes"},
                          absl::StrCat("the sequence has ", bytes.size(),
                                       " bytes, the limit (--max-upload-bytes) is ",
                                       files_->limits().max_upload_bytes));
  }
  PLEAT_RETURN_IF_ERROR(progress.Report(.5));
  PLEAT_ASSIGN_OR_RETURN(const SpaceReservation room, files_->ReserveRoom(bytes.size()));
  const SequenceInfo info = MakeSequenceInfo(sequence, SequenceId(bytes), bytes.size());
  PLEAT_RETURN_IF_ERROR(
      files_->Add(EntryKind::kSequence, {info.id, EncodeRecord(info)}, bytes, ttl));
  PLEAT_RETURN_IF_ERROR(progress.Report(1));
  return Get(info.id);
}

absl::StatusOr<SequenceInfo> LocalSequences::Get(const std::string& id) {
  return GetStored<SequenceInfo>(files_->catalog(), id);
}

absl::StatusOr<Page<SequenceInfo>> LocalSequences::ListPage(const PageRequest& request) {
  return ListStoredPage<SequenceInfo>(files_, request);
}

absl::Status LocalSequences::Delete(const std::string& id) {
  return files_->Delete(EntryKind::kSequence, id);
}

absl::Status LocalSequences::SetPinned(const std::string& id, bool pinned) {
  return files_->catalog().SetPinned(EntryKind::kSequence, id, pinned);
}

absl::StatusOr<std::unique_ptr<ContentDownload>> LocalSequences::OpenDownload(
    const std::string& id, uint64_t offset_bytes) {
  return files_->OpenDownload(EntryKind::kSequence, id, offset_bytes);
}

absl::Status LocalSequences::DeleteUpload(const std::string& id) {
  PLEAT_ASSIGN_OR_RETURN(UploadArea* const uploads, files_->uploads());
  return uploads->Remove(id);
}

absl::StatusOr<UploadStatus> LocalSequences::QueryUpload(const std::string& id) {
  // The id is the hash of the bytes, and no bytes are a sequence and a compressed sequence at once,
  // so one question serves both kinds of upload.
  const absl::StatusOr<SequenceInfo> sequence = Get(id);
  if (sequence.ok() && files_->IsIntact(id)) return UploadStatus{sequence->size_bytes, true};
  const absl::StatusOr<CompressedSequenceInfo> compressed =
      GetStored<CompressedSequenceInfo>(files_->catalog(), id);
  if (compressed.ok() && files_->IsIntact(id)) return UploadStatus{compressed->size_bytes, true};
  // An entry whose file is gone or damaged, or whose row cannot be read, is made whole by an
  // upload.
  for (const absl::Status& status : {sequence.status(), compressed.status()}) {
    if (!status.ok() && !absl::IsNotFound(status) && !absl::IsDataLoss(status)) return status;
  }
  for (const EntryKind kind : {EntryKind::kSequence, EntryKind::kCompressedSequence}) {
    if (const auto shared = files_->FindShared(kind, id)) {
      return UploadStatus{shared->file_bytes, true};
    }
  }
  PLEAT_ASSIGN_OR_RETURN(UploadArea* const uploads, files_->uploads());
  return UploadStatus{uploads->ReceivedBytes(id), false};
}

absl::StatusOr<std::unique_ptr<SequenceUpload>> LocalSequences::BeginUpload(const std::string& id,
                                                                            uint64_t size_bytes,
                                                                            uint64_t offset_bytes,
                                                                            absl::Duration ttl) {
  PLEAT_ASSIGN_OR_RETURN(std::unique_ptr<SequenceUpload> known,
                         FindComplete<SequenceInfo>(files_, id, ttl));
  if (known != nullptr) return known;
  PLEAT_ASSIGN_OR_RETURN(StoredFiles::BegunUpload upload,
                         files_->BeginUpload(id, size_bytes, offset_bytes));
  return std::make_unique<StoredUpload<SequenceInfo>>(
      std::move(upload),
      [this, ttl](pleat::Upload* complete) { return FinishUpload(complete, ttl); });
}

absl::StatusOr<SequenceInfo> LocalSequences::FinishUpload(pleat::Upload* upload,
                                                          absl::Duration ttl) {
  // The file and, beside it, the sequence, whose numbers the file has as they are in memory.
  PLEAT_ASSIGN_OR_RETURN(const Reservation memory,
                         files_->ReserveForUpload(kCheckFactor * upload->size_bytes()));
  PLEAT_ASSIGN_OR_RETURN(const std::string bytes, upload->ReadComplete());
  absl::StatusOr<MeshSequence> sequence = DecodeSequence(bytes, FileLimits(files_->limits()));
  absl::Status status = sequence.status();
  if (status.ok()) status = Check(*sequence);
  if (!status.ok()) {
    upload->Discard();  // these bytes will never be a sequence
    return status;
  }
  const SequenceInfo info = MakeSequenceInfo(*sequence, upload->id(), bytes.size());
  PLEAT_RETURN_IF_ERROR(
      files_->Add(EntryKind::kSequence, {info.id, EncodeRecord(info)}, upload, ttl));
  return Get(info.id);
}

absl::StatusOr<MeshSequence> LocalSequences::Load(const std::string& id) {
  PLEAT_RETURN_IF_ERROR(Get(id).status());
  PLEAT_ASSIGN_OR_RETURN(const std::string bytes, files_->Read(id));
  return DecodeSequence(bytes, FileLimits(files_->limits()));
}

}  // namespace pleat
