#include <cstddef>
#include <cstdint>
#include <string_view>

#include "clip_motion.h"
#include "glb_joints.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  // Any skin with these names; the seeds have them.
  static const pleat::Skeleton skeleton =
      pleat::Skeleton::Create({{"a", -1, {0, 0, 0}}, {"b", 0, {0, 1, 0}}}).value();
  pleat::MeshLimits limits;
  limits.max_frames = 200;
  pleat::InputReport report;
  const auto clip = pleat::DecodeGlbJoints(
      std::string_view(reinterpret_cast<const char*>(data), size), skeleton, {}, limits, &report);
  if (!clip.ok() || !clip->has_value()) return 0;
  const auto motion = pleat::MotionFromClip(**clip, skeleton);
  if (motion.ok() && motion->track.num_joints() != 2) __builtin_trap();
  return 0;
}
