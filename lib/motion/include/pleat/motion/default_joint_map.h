// The table from which people start: which joint of a clip drives which bone of a character.
#pragma once

#include <vector>

#include "absl/status/statusor.h"
#include "pleat/formats/joint_clip.h"
#include "pleat/formats/joint_map_file.h"
#include "pleat/motion/landmarks.h"
#include "pleat/skeleton/skeleton.h"

namespace pleat {

// Joints of the two skeletons that are the same landmark of a body are mapped
// (docs/method/motion.md#landmarks). kInvalidArgument names the landmarks that the clip or the
// character lacks: hips and legs are needed. All joints of the character are in the map.
absl::StatusOr<JointMap> MakeJointMap(const JointClip& clip, const Skeleton& skeleton);

// A map whose names were found in both skeletons.
struct ResolvedBone {
  int bone = 0;   // of the character
  int from = 0;   // of the clip, where the bone ends
  int turns = 0;  // of the clip, whose rotation it has
  int begin = 0;  // of the clip, where it begins: `from` of the next mapped bone above
  BoneAlignment alignment = BoneAlignment::kDirection;
};
// Parents before children; the root is first and is always there. kInvalidArgument names the entry
// and the joint that is not there, and lists those that are.
absl::StatusOr<std::vector<ResolvedBone>> ResolveJointMap(const JointMap& map,
                                                          const JointClip& clip,
                                                          const Skeleton& skeleton);

}  // namespace pleat
