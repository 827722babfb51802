// Rows of the catalog, which a damaged disk may have changed. What can be read can be written, and
// is then read as the same.
#include <cstddef>
#include <cstdint>
#include <string>

#include "pleat/store/records.h"

namespace {

template <typename Info>
void Check(absl::StatusOr<Info> (*decode)(const std::string&), const std::string& bytes) {
  const absl::StatusOr<Info> info = decode(bytes);
  if (!info.ok()) return;
  const std::string written = pleat::EncodeRecord(*info);
  const absl::StatusOr<Info> again = decode(written);
  if (!again.ok() || pleat::EncodeRecord(*again) != written) __builtin_trap();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  const std::string bytes(reinterpret_cast<const char*>(data), size);
  Check<pleat::SequenceInfo>(&pleat::DecodeSequenceRecord, bytes);
  Check<pleat::ModelInfo>(&pleat::DecodeModelRecord, bytes);
  Check<pleat::JobInfo>(&pleat::DecodeJobRecord, bytes);
  Check<pleat::CompressedSequenceInfo>(&pleat::DecodeCompressedSequenceRecord, bytes);
  Check<pleat::CheckpointInfo>(&pleat::DecodeCheckpointRecord, bytes);
  return 0;
}
