// Sequences: uploads, the catalogue, reading them for jobs.
#include <utility>

#include "absl/strings/str_cat.h"
#include "infos.h"
#include "pleat/base/status.h"
#include "pleat/formats/sequence_file.h"
#include "pleat/local/local_character_service.h"
#include "stored_infos.h"

namespace pleat {
namespace {

MeshFileLimits FileLimits(const ServiceLimits& limits) {
  return {.max_file_bytes = limits.max_upload_bytes,
          .max_vertices = limits.max_vertices,
          .max_faces = 2 * limits.max_vertices,
          .max_frames = limits.max_frames,
          .max_sequence_bytes = 2 * limits.max_upload_bytes};
}

}  // namespace

absl::Status LocalCharacterService::CheckSequence(const MeshSequence& sequence) const {
  const ServiceLimits& limits = options_.limits;
  if (sequence.num_vertices() > limits.max_vertices) {
    return absl::ResourceExhaustedError(absl::StrCat("the sequence has ", sequence.num_vertices(),
                                                     " vertices, the limit (--max-vertices) is ",
                                                     limits.max_vertices));
  }
  if (sequence.num_frames() > limits.max_frames) {
    return absl::ResourceExhaustedError(absl::StrCat("the sequence has ", sequence.num_frames(),
                                                     " frames, the limit (--max-frames) is ",
                                                     limits.max_frames));
  }
  return absl::OkStatus();
}

absl::StatusOr<SequenceInfo> LocalCharacterService::UploadSequence(const MeshSequence& sequence,
                                                                   const Progress& progress) {
  PLEAT_RETURN_IF_ERROR(CheckSequence(sequence));
  const std::string bytes = EncodeSequence(sequence);
  if (bytes.size() > options_.limits.max_upload_bytes) {
    return absl::ResourceExhaustedError(absl::StrCat("the sequence has ", bytes.size(),
                                                     " bytes, the limit (--max-upload-bytes) is ",
                                                     options_.limits.max_upload_bytes));
  }
  PLEAT_RETURN_IF_ERROR(progress.Report(.5));
  SequenceInfo info = MakeSequenceInfo(sequence, SequenceId(bytes), bytes.size());
  PLEAT_RETURN_IF_ERROR(store_->Add(EntryKind::kSequence, {info.id, EncodeRecord(info)}, bytes));
  PLEAT_RETURN_IF_ERROR(progress.Report(1));
  return info;
}

absl::StatusOr<SequenceInfo> LocalCharacterService::GetSequence(const std::string& id) {
  return GetStored<SequenceInfo>(store_->catalogue(), id);
}

absl::StatusOr<std::vector<SequenceInfo>> LocalCharacterService::ListSequences() {
  return ListStored<SequenceInfo>(store_->catalogue());
}

absl::Status LocalCharacterService::DeleteSequence(const std::string& id) {
  return store_->Delete(EntryKind::kSequence, id);
}

absl::StatusOr<UploadStatus> LocalCharacterService::QueryUpload(const std::string& id) {
  // An id is of one kind of file only, whatever it was uploaded as.
  const absl::StatusOr<SequenceInfo> sequence = GetSequence(id);
  if (sequence.ok()) return UploadStatus{sequence->size_bytes, true};
  const absl::StatusOr<CompressedSequenceInfo> compressed = GetCompressedSequence(id);
  if (compressed.ok()) return UploadStatus{compressed->size_bytes, true};
  for (const absl::Status& status : {sequence.status(), compressed.status()}) {
    if (status.code() != absl::StatusCode::kNotFound) return status;
  }
  return UploadStatus{store_->uploads().ReceivedBytes(id), false};
}

absl::StatusOr<std::unique_ptr<Upload>> LocalCharacterService::BeginUpload(const std::string& id,
                                                                           uint64_t size_bytes,
                                                                           uint64_t offset_bytes) {
  if (size_bytes == 0) return absl::InvalidArgumentError("an upload of 0 bytes is nothing to keep");
  if (size_bytes > options_.limits.max_upload_bytes) {
    return absl::ResourceExhaustedError(absl::StrCat("the upload has ", size_bytes,
                                                     " bytes, the limit (--max-upload-bytes) is ",
                                                     options_.limits.max_upload_bytes));
  }
  if (offset_bytes > size_bytes) {
    return absl::OutOfRangeError(absl::StrCat(
        "offset ", offset_bytes, " is behind the end of an upload of ", size_bytes, " bytes"));
  }
  PLEAT_RETURN_IF_ERROR(store_->blobs().CheckSpace(size_bytes - offset_bytes));
  return store_->uploads().Begin(id, size_bytes, offset_bytes);
}

absl::StatusOr<SequenceInfo> LocalCharacterService::FinishUpload(Upload* upload) {
  PLEAT_ASSIGN_OR_RETURN(const std::string bytes, upload->ReadComplete());
  absl::StatusOr<MeshSequence> sequence = DecodeSequence(bytes, FileLimits(options_.limits));
  absl::Status status = sequence.status();
  if (status.ok()) status = CheckSequence(*sequence);
  if (!status.ok()) {
    upload->Discard();  // these bytes will never be a sequence
    return status;
  }
  SequenceInfo info = MakeSequenceInfo(*sequence, upload->id(), bytes.size());
  PLEAT_RETURN_IF_ERROR(store_->Add(EntryKind::kSequence, {info.id, EncodeRecord(info)}, upload));
  return info;
}

absl::StatusOr<MeshSequence> LocalCharacterService::LoadSequence(const std::string& id) {
  PLEAT_RETURN_IF_ERROR(GetSequence(id).status());
  PLEAT_ASSIGN_OR_RETURN(const std::string bytes, store_->blobs().Get(id));
  return DecodeSequence(bytes, FileLimits(options_.limits));
}

}  // namespace pleat
