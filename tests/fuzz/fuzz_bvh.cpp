#include <cstddef>
#include <cstdint>
#include <string_view>

#include "clip_motion.h"
#include "pleat/formats/bvh.h"
#include "pleat/skeleton/human_template.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  const auto file = pleat::DecodeBvh(std::string_view(reinterpret_cast<const char*>(data), size));
  if (!file.ok()) return 0;
  const pleat::JointClip& clip = file->clip;
  if (clip.num_frames() == 0 || clip.translations.size() != clip.rotations.size()) {
    __builtin_trap();
  }
  pleat::GuessUnit(clip);
  if (const auto motion = pleat::MotionFromClip(clip, pleat::HumanTemplate()); motion.ok()) {
    if (motion->track.num_joints() != 18) __builtin_trap();
  }
  // What was read can be written and comes back with the same frames, where it has one root and
  // the ends that writing adds stay within the limits.
  if (clip.num_joints() > 2000 || clip.rotations.size() > 1'000'000) return 0;
  for (size_t j = 1; j < clip.num_joints(); ++j) {
    if (clip.joints[j].parent < 0) return 0;
  }
  const auto back = pleat::DecodeBvh(pleat::EncodeBvh(clip, {.unit_m = 1}));
  if (!back.ok() || back->clip.num_frames() != clip.num_frames()) __builtin_trap();
  return 0;
}
