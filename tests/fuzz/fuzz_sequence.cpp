#include <cstddef>
#include <cstdint>
#include <string>

#include "pleat/formats/sequence_file.h"
#include "support/hostile_bytes.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  // With the right checksum, so that the fuzzer gets behind it.
  const std::string bytes = pleat::Reseal({reinterpret_cast<const char*>(data), size});
  const auto sequence = pleat::DecodeSequence(bytes);
  if (sequence.ok() && pleat::EncodeSequence(*sequence) != bytes) __builtin_trap();
  return 0;
}
