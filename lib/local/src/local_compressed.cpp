// Compressed sequences: uploads, the catalogue, decoding.
#include <algorithm>
#include <utility>

#include "absl/strings/str_cat.h"
#include "pleat/base/sha256.h"
#include "pleat/base/status.h"
#include "pleat/local/local_character_service.h"
#include "stored_infos.h"

namespace pleat {
namespace {

CompressedSequenceInfo MakeInfo(const SequenceDecoder& decoder, const std::string& id,
                                uint64_t size_bytes) {
  return {.id = id,
          .name = decoder.name(),
          .num_frames = decoder.num_frames(),
          .num_vertices = decoder.num_vertices(),
          .num_faces = decoder.topology().num_faces(),
          .frame_rate = decoder.frame_rate(),
          .size_bytes = size_bytes,
          .record = std::nullopt};
}

}  // namespace

absl::StatusOr<SequenceDecoder> LocalCharacterService::OpenDecoder(std::string bytes) const {
  const ServiceLimits& limits = options_.limits;
  return SequenceDecoder::Open(std::move(bytes),
                               {.max_vertices = static_cast<uint32_t>(limits.max_vertices),
                                .max_faces = static_cast<uint32_t>(2 * limits.max_vertices),
                                .max_frames = static_cast<uint32_t>(limits.max_frames),
                                .max_field_bytes = options_.decode_bytes});
}

absl::StatusOr<CompressedSequenceInfo> LocalCharacterService::UploadCompressedSequence(
    const std::string& file, const Progress& progress) {
  const std::string id = ToHex(ComputeSha256(file));
  PLEAT_RETURN_IF_ERROR(progress.Report(0));
  PLEAT_ASSIGN_OR_RETURN(const std::unique_ptr<Upload> upload, BeginUpload(id, file.size(), 0));
  PLEAT_RETURN_IF_ERROR(upload->Append(file));
  PLEAT_ASSIGN_OR_RETURN(CompressedSequenceInfo info, FinishCompressedUpload(upload.get()));
  PLEAT_RETURN_IF_ERROR(progress.Report(1));
  return info;
}

absl::StatusOr<CompressedSequenceInfo> LocalCharacterService::FinishCompressedUpload(
    Upload* upload) {
  // The same file made by a job has a record that an upload must not replace.
  absl::StatusOr<CompressedSequenceInfo> known = GetCompressedSequence(upload->id());
  PLEAT_ASSIGN_OR_RETURN(std::string bytes, upload->ReadComplete());
  if (known.ok()) {
    upload->Discard();
    return known;
  }
  PLEAT_ASSIGN_OR_RETURN(const Reservation memory,
                         decode_memory_.Reserve(bytes.size(), "checking the upload"));
  const uint64_t size_bytes = bytes.size();
  const absl::StatusOr<SequenceDecoder> decoder = OpenDecoder(std::move(bytes));
  if (!decoder.ok()) {
    upload->Discard();  // these bytes will never be a compressed sequence
    return decoder.status();
  }
  CompressedSequenceInfo info = MakeInfo(*decoder, upload->id(), size_bytes);
  PLEAT_RETURN_IF_ERROR(
      store_->Add(EntryKind::kCompressedSequence, {info.id, EncodeRecord(info)}, upload));
  return info;
}

absl::StatusOr<CompressedSequenceInfo> LocalCharacterService::GetCompressedSequence(
    const std::string& id) {
  return GetStored<CompressedSequenceInfo>(store_->catalogue(), id);
}

absl::StatusOr<std::vector<CompressedSequenceInfo>>
LocalCharacterService::ListCompressedSequences() {
  return ListStored<CompressedSequenceInfo>(store_->catalogue());
}

absl::Status LocalCharacterService::DeleteCompressedSequence(const std::string& id) {
  return store_->Delete(EntryKind::kCompressedSequence, id);
}

absl::StatusOr<std::string> LocalCharacterService::DownloadCompressedSequence(
    const std::string& id, const Progress& progress) {
  PLEAT_ASSIGN_OR_RETURN(const CompressedSequenceInfo info, GetCompressedSequence(id));
  return Download(EntryKind::kCompressedSequence, id, info.size_bytes, progress);
}

absl::StatusOr<std::unique_ptr<DecodeSession>> LocalCharacterService::OpenDecode(
    const std::string& id, FrameRange range) {
  PLEAT_ASSIGN_OR_RETURN(const CompressedSequenceInfo info, GetCompressedSequence(id));
  const std::string what = absl::StrCat("decoding '", id, "'");
  // First the file, then all that its decoder will take.
  PLEAT_ASSIGN_OR_RETURN(Reservation memory, decode_memory_.Reserve(info.size_bytes, what));
  PLEAT_ASSIGN_OR_RETURN(std::string bytes, store_->blobs().Get(id));
  PLEAT_ASSIGN_OR_RETURN(SequenceDecoder decoder, OpenDecoder(std::move(bytes)));
  memory = Reservation();
  PLEAT_ASSIGN_OR_RETURN(memory, decode_memory_.Reserve(decoder.memory_bytes(), what));
  return DecodeSession::Open(std::move(decoder), range, std::move(memory));
}

absl::Status LocalCharacterService::DecodeFrames(const std::string& id, FrameRange range,
                                                 const DecodedFramesSink& sink) {
  PLEAT_ASSIGN_OR_RETURN(const std::unique_ptr<DecodeSession> session, OpenDecode(id, range));
  return DecodeInto(session.get(), sink);
}

}  // namespace pleat
