#include <cstddef>
#include <cstdint>
#include <string_view>

#include "fuzz/resolve_rig.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  const auto file =
      pleat::DecodeRigGlb(std::string_view(reinterpret_cast<const char*>(data), size));
  if (file.ok()) pleat::ResolveForSmallClip(*file);
  return 0;
}
