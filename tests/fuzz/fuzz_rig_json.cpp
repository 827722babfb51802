#include <cstddef>
#include <cstdint>
#include <string_view>

#include "pleat/formats/rig_file.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  const auto file =
      pleat::DecodeRigJson(std::string_view(reinterpret_cast<const char*>(data), size));
  if (!file.ok()) return 0;
  for (const auto& vertex : file->influences) {
    for (const pleat::JointInfluence& influence : vertex) {
      if (influence.joint < 0 || influence.joint >= file->skeleton.num_joints()) __builtin_trap();
    }
  }
  return 0;
}
