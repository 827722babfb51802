// Checkpoints of trainings, and whether what was read may go into a training.
#include <cstddef>
#include <cstdint>
#include <string>

#include "pleat/formats/checkpoint_file.h"
#include "support/hostile_bytes.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  // With the right checksum, so that the fuzzer gets behind it.
  const std::string bytes = pleat::Reseal({reinterpret_cast<const char*>(data), size});
  pleat::MeshLimits limits;
  limits.max_unfolded_bytes = 1 << 28;
  const auto file = pleat::DecodeCheckpoint(bytes, limits);
  if (!file.ok()) return 0;
  pleat::CheckTrainingCheckpoint(file->checkpoint, 8, 3, 3, {0, 2}).IgnoreError();
  // What reads, writes to bytes that read back to the same.
  const std::string written = pleat::EncodeCheckpoint(*file);
  const auto again = pleat::DecodeCheckpoint(written, limits);
  if (!again.ok() || pleat::EncodeCheckpoint(*again) != written) __builtin_trap();
  return 0;
}
