#include "pleat/local/local_compressed_sequences.h"

#include <algorithm>
#include <utility>

#include "absl/strings/str_cat.h"
#include "infos.h"
#include "pleat/base/sha256.h"
#include "pleat/base/status.h"
#include "pleat/service/compression.h"
#include "stored_infos.h"

namespace pleat {
namespace {

// A session that holds the reservation of its memory as long as it lives.
class ReservedSession final : public DecodeSession {
 public:
  ReservedSession(std::unique_ptr<DecodeSession> session, Reservation memory)
      : memory_(std::move(memory)), session_(std::move(session)) {}
  absl::StatusOr<MeshSequence> Shape() override { return session_->Shape(); }
  absl::StatusOr<const Eigen::Matrix3Xf*> Next() override { return session_->Next(); }

 private:
  const Reservation memory_;  // declared first, so that it is given back when session_ is gone
  const std::unique_ptr<DecodeSession> session_;
};

}  // namespace

absl::StatusOr<SequenceDecoder> LocalCompressedSequences::OpenDecoder(std::string bytes) const {
  const ServiceLimits& limits = files_->limits();
  return SequenceDecoder::Open(std::move(bytes),
                               {.max_vertices = static_cast<uint32_t>(limits.max_vertices),
                                .max_faces = static_cast<uint32_t>(2 * limits.max_vertices),
                                .max_frames = static_cast<uint32_t>(limits.max_frames),
                                .max_field_bytes = memory_->capacity_bytes()});
}

absl::StatusOr<CompressedSequenceInfo> LocalCompressedSequences::Upload(const std::string& file,
                                                                        const Progress& progress,
                                                                        absl::Duration ttl) {
  const std::string id = ToHex(ComputeSha256(file));
  PLEAT_RETURN_IF_ERROR(progress.Report(0));
  PLEAT_ASSIGN_OR_RETURN(const std::unique_ptr<CompressedSequenceUpload> upload,
                         BeginUpload(id, file.size(), 0, ttl));
  PLEAT_RETURN_IF_ERROR(upload->Append(file));
  PLEAT_ASSIGN_OR_RETURN(CompressedSequenceInfo info, upload->Finish());
  PLEAT_RETURN_IF_ERROR(progress.Report(1));
  return info;
}

absl::StatusOr<std::unique_ptr<CompressedSequenceUpload>> LocalCompressedSequences::BeginUpload(
    const std::string& id, uint64_t size_bytes, uint64_t offset_bytes, absl::Duration ttl) {
  PLEAT_ASSIGN_OR_RETURN(std::unique_ptr<CompressedSequenceUpload> known,
                         FindComplete<CompressedSequenceInfo>(files_, id, ttl));
  if (known != nullptr) return known;
  PLEAT_ASSIGN_OR_RETURN(StoredFiles::BegunUpload upload,
                         files_->BeginUpload(id, size_bytes, offset_bytes));
  return std::make_unique<StoredUpload<CompressedSequenceInfo>>(
      std::move(upload),
      [this, ttl](pleat::Upload* complete) { return FinishUpload(complete, ttl); });
}

absl::StatusOr<CompressedSequenceInfo> LocalCompressedSequences::FinishUpload(pleat::Upload* upload,
                                                                              absl::Duration ttl) {
  // When a job has made the same file, its row has a record that an upload must not replace. The
  // bytes that came are checked all the same.
  absl::StatusOr<CompressedSequenceInfo> known = Get(upload->id());
  PLEAT_ASSIGN_OR_RETURN(const Reservation file_memory,
                         files_->ReserveForUpload(upload->size_bytes()));
  PLEAT_ASSIGN_OR_RETURN(std::string bytes, upload->ReadComplete());
  PLEAT_ASSIGN_OR_RETURN(const std::unique_ptr<CompressedSequenceUpload> stored,
                         FindComplete<CompressedSequenceInfo>(files_, upload->id(), ttl));
  if (stored != nullptr) {  // a job was faster
    upload->Discard();
    return stored->Finish();
  }
  PLEAT_ASSIGN_OR_RETURN(const Reservation memory,
                         memory_->Reserve(bytes.size(), "checking the upload"));
  const uint64_t size_bytes = bytes.size();
  const absl::StatusOr<SequenceDecoder> decoder = OpenDecoder(std::move(bytes));
  if (!decoder.ok()) {
    upload->Discard();  // these bytes will never be a compressed sequence
    return decoder.status();
  }
  const CompressedSequenceInfo info =
      known.ok() ? *std::move(known)
                 : MakeCompressedSequenceInfo(*decoder, upload->id(), size_bytes);
  PLEAT_RETURN_IF_ERROR(
      files_->Add(EntryKind::kCompressedSequence, {info.id, EncodeRecord(info)}, upload, ttl));
  return Get(info.id);
}

absl::StatusOr<CompressedSequenceInfo> LocalCompressedSequences::Get(const std::string& id) {
  return GetStored<CompressedSequenceInfo>(files_->catalog(), id);
}

absl::StatusOr<Page<CompressedSequenceInfo>> LocalCompressedSequences::ListPage(
    const PageRequest& request) {
  return ListStoredPage<CompressedSequenceInfo>(files_, request);
}

absl::Status LocalCompressedSequences::SetPinned(const std::string& id, bool pinned) {
  return files_->catalog().SetPinned(EntryKind::kCompressedSequence, id, pinned);
}

absl::Status LocalCompressedSequences::Delete(const std::string& id) {
  return files_->Delete(EntryKind::kCompressedSequence, id);
}

absl::StatusOr<std::string> LocalCompressedSequences::Download(const std::string& id,
                                                               const Progress& progress) {
  PLEAT_ASSIGN_OR_RETURN(const CompressedSequenceInfo info, Get(id));
  return files_->Download(EntryKind::kCompressedSequence, id, info.size_bytes, progress);
}

absl::StatusOr<std::unique_ptr<ContentDownload>> LocalCompressedSequences::OpenDownload(
    const std::string& id, uint64_t offset_bytes) {
  return files_->OpenDownload(EntryKind::kCompressedSequence, id, offset_bytes);
}

absl::StatusOr<std::unique_ptr<DecodeSession>> LocalCompressedSequences::OpenDecode(
    const std::string& id, FrameRange range) {
  PLEAT_ASSIGN_OR_RETURN(const CompressedSequenceInfo info, Get(id));
  const int end_frame = range.end == 0 ? info.num_frames : range.end;
  if (frames_ != nullptr && end_frame > range.begin) {
    PLEAT_RETURN_IF_ERROR(frames_->Take(std::min(end_frame, info.num_frames) - range.begin));
  }
  const std::string what = absl::StrCat("decoding '", id, "'");
  // The memory is reserved in two steps, because only the opened file says what its decoder will
  // take: first for the bytes of the file, then for everything.
  PLEAT_ASSIGN_OR_RETURN(Reservation memory, memory_->Reserve(info.size_bytes, what));
  PLEAT_ASSIGN_OR_RETURN(std::string bytes, files_->Read(id));
  PLEAT_ASSIGN_OR_RETURN(SequenceDecoder decoder, OpenDecoder(std::move(bytes)));
  memory = Reservation();
  PLEAT_ASSIGN_OR_RETURN(memory, memory_->Reserve(decoder.memory_bytes(), what));
  PLEAT_ASSIGN_OR_RETURN(std::unique_ptr<DecodeSession> session,
                         MakeDecodeSession(std::move(decoder), range));
  return std::make_unique<ReservedSession>(std::move(session), std::move(memory));
}

}  // namespace pleat
