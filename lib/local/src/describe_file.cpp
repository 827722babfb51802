#include "pleat/local/describe_file.h"

#include <memory>

#include "infos.h"
#include "pleat/formats/checkpoint_file.h"
#include "pleat/formats/model_file.h"
#include "pleat/formats/sequence_file.h"
#include "pleat/store/records.h"

namespace pleat {

absl::StatusOr<FileDescription> DescribeStoredFile(const std::string& id,
                                                   const std::string& bytes) {
  if (const absl::StatusOr<MeshSequence> sequence = DecodeSequence(bytes); sequence.ok()) {
    return FileDescription{EntryKind::kSequence,
                           EncodeRecord(MakeSequenceInfo(*sequence, id, bytes.size()))};
  }
  if (const auto model = DecodeModel(bytes); model.ok()) {
    return FileDescription{EntryKind::kModel,
                           EncodeRecord(MakeModelInfo(**model, id, bytes.size()))};
  }
  if (const absl::StatusOr<SequenceDecoder> decoder = SequenceDecoder::Open(bytes, {});
      decoder.ok()) {
    return FileDescription{EntryKind::kCompressedSequence,
                           EncodeRecord(MakeCompressedSequenceInfo(*decoder, id, bytes.size()))};
  }
  if (const absl::StatusOr<CheckpointFile> checkpoint = DecodeCheckpoint(bytes); checkpoint.ok()) {
    return FileDescription{EntryKind::kCheckpoint,
                           EncodeRecord(CheckpointInfo{.job_id = checkpoint->job_id})};
  }
  return absl::InvalidArgumentError(
      "neither a sequence nor a model nor a compressed sequence nor a checkpoint");
}

}  // namespace pleat
