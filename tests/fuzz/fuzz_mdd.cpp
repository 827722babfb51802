#include <cstddef>
#include <cstdint>
#include <string_view>

#include "pleat/formats/mdd.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  const auto cache = pleat::DecodeMdd(bytes, "fuzz.mdd");
  // The format has one form only: what reads, writes back to the same bytes.
  if (cache.ok() && pleat::EncodeMdd(*cache) != bytes) __builtin_trap();
  return 0;
}
