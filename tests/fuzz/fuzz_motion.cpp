#include <cstddef>
#include <cstdint>
#include <string_view>

#include "pleat/formats/motion_file.h"
#include "pleat/skeleton/human_template.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  const auto motion = pleat::DecodeMotion(
      std::string_view(reinterpret_cast<const char*>(data), size), pleat::HumanTemplate());
  if (!motion.ok()) return 0;
  for (const pleat::Pose& pose : motion->track.poses()) {
    if (pose.rotations.size() != 18) __builtin_trap();
  }
  return 0;
}
