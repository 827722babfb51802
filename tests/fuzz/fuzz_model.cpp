#include <cstddef>
#include <cstdint>
#include <string>

#include "pleat/formats/model_file.h"
#include "support/hostile_bytes.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  // With the right checksum, so that the fuzzer gets behind it.
  const std::string bytes = pleat::Reseal({reinterpret_cast<const char*>(data), size});
  pleat::MeshLimits limits;
  limits.max_unfolded_bytes = 1 << 28;
  const auto model = pleat::DecodeModel(bytes, limits);
  if (!model.ok()) return 0;
  // What reads, writes to bytes that read back to the same.
  const std::string written = pleat::EncodeModel(**model);
  const auto again = pleat::DecodeModel(written, limits);
  if (!again.ok() || pleat::EncodeModel(**again) != written) __builtin_trap();
  return 0;
}
