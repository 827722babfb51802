#include <cstddef>
#include <cstdint>
#include <string_view>

#include "fuzz/resolve_rig.h"
#include "gltf_file.h"

// glTF text whose buffers are in the text itself: there is no folder beside it.
extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  const auto packed = pleat::PackGltf(text, "/nonexistent/rig.gltf", pleat::MeshLimits());
  if (!packed.ok()) return 0;
  const auto file = pleat::DecodeRigGlb(*packed);
  if (file.ok()) pleat::ResolveForSmallClip(*file);
  return 0;
}
