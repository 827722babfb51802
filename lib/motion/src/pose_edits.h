// Edits of each pose where it stands in time.
#pragma once

#include <vector>

#include "absl/status/status.h"
#include "body_axes.h"
#include "pleat/math/clip_starts.h"
#include "pleat/skeleton/pose.h"
#include "pleat/skeleton/skeleton.h"

namespace pleat {

// The angle of each rotation times `factor`. Rotations are unwrapped along time: otherwise a turn
// past 180 degrees would jump when it is scaled.
void ScaleRotations(const std::vector<int>& joints, double factor, std::vector<Pose>* poses);
// Turned by `offset` after the motion's own rotation, about the axes of the rest pose as the parent
// bone carries them.
void OffsetRotations(const std::vector<int>& joints, const Eigen::Quaterniond& offset,
                     std::vector<Pose>* poses);
// A rotation is a twist about the bone and then a swing of it; both angles are cut at their limit.
// The root has no bone: all of its rotation is a swing.
void LimitRotations(const Skeleton& skeleton, const std::vector<int>& joints, double max_swing_rad,
                    double max_twist_rad, std::vector<Pose>* poses);
// Gaussian means over time with a standard deviation of half of `seconds`, in each clip. The root
// is smoothed with its position.
void SmoothRotations(const std::vector<int>& joints, double seconds, double fps,
                     const std::vector<int>& clip_starts, std::vector<Pose>* poses);
// Left becomes right in the plane that halves the rest pose, moved to where the clip begins.
void MirrorPoses(const BodyAxes& axes, const std::vector<int>& clip_starts,
                 std::vector<Pose>* poses);

}  // namespace pleat
