#include "record_kinds.h"

#include "pleat/store/records.h"

namespace pleat {

absl::Status CheckRecord(EntryKind kind, const std::string& record) {
  switch (kind) {
    case EntryKind::kSequence:
      return DecodeSequenceRecord(record).status();
    case EntryKind::kModel:
      return DecodeModelRecord(record).status();
    case EntryKind::kCompressedSequence:
      return DecodeCompressedSequenceRecord(record).status();
    case EntryKind::kJob:
      return DecodeJobRecord(record).status();
    case EntryKind::kRig:
      return absl::OkStatus();
    case EntryKind::kCheckpoint:
      return DecodeCheckpointRecord(record).status();
  }
  return absl::InternalError("an unknown kind of entry");
}

}  // namespace pleat
