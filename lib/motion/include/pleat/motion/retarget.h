// The clip of another skeleton as the motion of a character (docs/method/motion.md#retargeting).
#pragma once

#include <array>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "pleat/formats/joint_clip.h"
#include "pleat/formats/joint_map_file.h"
#include "pleat/motion/foot_contacts.h"
#include "pleat/skeleton/pose_track.h"
#include "pleat/skeleton/skeleton.h"

namespace pleat {

struct RetargetOptions {
  // Puts the feet as high as they are at rest where those of the clip stand. Without it, heights
  // are those of the scaled clip.
  bool on_floor = true;
};

struct RetargetReport {
  UnitGuess unit;           // of the clip, judged by its size
  double scale = 1;         // meters of the character per unit of the clip
  ClipUp up = ClipUp::kY;   // of the clip
  bool rest_stands = true;  // false: its rest is no standing body, and was solved from its motion
  double leg_length_m = 0;  // of the character
  double ground_shift_m = 0;
  // The left foot, then the right one. Contacts are those of the clip.
  std::array<FootContacts, 2> contacts{};
  FootSliding clip_sliding{}, sliding{};  // of the scaled clip, and of the character
  std::vector<std::string> warnings{};
};

// Drives the bones that `map` names. Bones that it does not name follow the bone above them.
// kInvalidArgument says what of the map is not there, or why the clip cannot be used.
absl::StatusOr<PoseTrack> Retarget(const JointClip& clip, const JointMap& map,
                                   const Skeleton& skeleton, const RetargetOptions& options,
                                   RetargetReport* report);

}  // namespace pleat
