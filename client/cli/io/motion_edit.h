// Small edits of a motion, which try out a character with poses that it was not trained on.
#pragma once

#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "pleat/skeleton/pose_track.h"
#include "pleat/skeleton/skeleton.h"

namespace pleat {

// Edits as they are given on the command line. The joint name "all" means every joint except the
// root.
struct MotionEdits {
  std::vector<std::string> scale_rotation;  // "joint=factor": the angle times the factor
  // "joint=x,y,z": intrinsic X-Y-Z angles in degrees, turned after the motion's own rotation about
  // the axes of the rest pose as the parent bone carries them.
  std::vector<std::string> offset_rotation;
  std::vector<std::string> offset_root;  // "x,y,z": meters, in the world
  double time_scale = 1;                 // the duration times this, at the same frame rate
};

// Applies the edits in the order of the members. A usage error names a joint that is not in
// `joint_names` or a number that does not parse.
absl::StatusOr<PoseTrack> EditMotion(const std::vector<std::string>& joint_names, PoseTrack track,
                                     const MotionEdits& edits);

// Turns texts "joint=factor" into one factor per joint, which is 1 where none is given. Returns J
// entries, or none when `texts` is empty.
absl::StatusOr<std::vector<double>> ParseJointFactors(const std::vector<std::string>& joint_names,
                                                      const std::vector<std::string>& texts);

}  // namespace pleat
