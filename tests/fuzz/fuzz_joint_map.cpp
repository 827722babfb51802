#include <cstddef>
#include <cstdint>
#include <string_view>

#include "pleat/formats/bvh.h"
#include "pleat/formats/joint_map_file.h"
#include "pleat/motion/retarget.h"
#include "pleat/skeleton/human_template.h"

namespace {

// Two legs, as small as a clip for retargeting can be.
constexpr std::string_view kClip = R"(HIERARCHY
ROOT Hips { OFFSET 0 1 0 CHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation
JOINT LeftUpLeg { OFFSET .1 0 0 CHANNELS 1 Xrotation
JOINT LeftLeg { OFFSET 0 -.4 0 CHANNELS 1 Xrotation
JOINT LeftFoot { OFFSET 0 -.4 0 CHANNELS 0 End Site { OFFSET 0 0 .2 } } } }
JOINT RightUpLeg { OFFSET -.1 0 0 CHANNELS 1 Xrotation
JOINT RightLeg { OFFSET 0 -.4 0 CHANNELS 1 Xrotation
JOINT RightFoot { OFFSET 0 -.4 0 CHANNELS 0 End Site { OFFSET 0 0 .2 } } } } }
MOTION
Frames: 2
Frame Time: .033333
0 1 0 0 0 0 -20 40 10 20
0 1 .1 5 0 9 20 10 -20 40
)";

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  static const auto kFile = pleat::DecodeBvh(kClip);
  if (!kFile.ok()) __builtin_trap();
  const auto map =
      pleat::DecodeJointMap(std::string_view(reinterpret_cast<const char*>(data), size));
  if (!map.ok()) return 0;
  const auto back = pleat::DecodeJointMap(pleat::EncodeJointMap(*map));
  if (!back.ok() || back->joints.size() != map->joints.size()) __builtin_trap();
  pleat::RetargetReport report;
  const auto track = pleat::Retarget(kFile->clip, *map, pleat::HumanTemplate(), {}, &report);
  if (track.ok() && track->num_frames() != 2) __builtin_trap();
  return 0;
}
