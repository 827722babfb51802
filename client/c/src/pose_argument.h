// Poses of callers.
#pragma once

#include "absl/status/status.h"
#include "pleat.h"
#include "pleat/skeleton/pose.h"

namespace pleat {

// Copies the pose of a caller, whose joints are counted before they are read. It does not allocate
// once `pose` has the right size. What the numbers are is checked by CheckPose.
absl::Status TakePose(const pleat_pose& given, int num_joints, Pose* pose);

// Shows `pose` to a caller: its rotations are copied to `rotations` (4 J), which `shown` refers to.
void ShowPose(const Pose& pose, double* rotations, pleat_pose* shown);

}  // namespace pleat
