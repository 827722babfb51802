// Small edits of a motion, for trying out a character with poses it was not trained on.
#pragma once

#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "pleat/skeleton/pose_track.h"
#include "pleat/skeleton/skeleton.h"

namespace pleat {

// As given on the command line; a joint name of "all" means every joint but the root.
struct MotionEdits {
  std::vector<std::string> scale_rotation;  // "joint=factor": angle times factor
  // "joint=x,y,z": intrinsic X-Y-Z angles in degrees, turned after the motion's own rotation about
  // the axes of the rest pose as the parent bone carries them.
  std::vector<std::string> offset_rotation;
  std::vector<std::string> offset_root;  // "x,y,z": meters, world
  double time_scale = 1;                 // duration times this, same frame rate
};

// Applies the edits in the order of the members. A usage error names a joint that is not in
// `joint_names` or a number that does not parse.
absl::StatusOr<PoseTrack> EditMotion(const std::vector<std::string>& joint_names, PoseTrack track,
                                     const MotionEdits& edits);

// "joint=factor" texts -> one factor per joint, 1 where none is given (J entries, or empty when
// `texts` is empty).
absl::StatusOr<std::vector<double>> ParseJointFactors(const std::vector<std::string>& joint_names,
                                                      const std::vector<std::string>& texts);

}  // namespace pleat
