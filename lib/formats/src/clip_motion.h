// The joints of a file as the poses of a skeleton that has the same joints.
#pragma once

#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "pleat/formats/joint_clip.h"
#include "pleat/formats/motion_file.h"
#include "pleat/skeleton/skeleton.h"

namespace pleat {

// The joint of the clip for each joint of the skeleton, by name. Other joints may lie between them.
// kInvalidArgument names the joints that are missing, or those whose order in the hierarchy is
// another one.
absl::StatusOr<std::vector<int>> MatchJoints(const JointClip& clip, const Skeleton& skeleton);

// Joints are matched by name, and a bone turns as the joint above its end does. The rest pose of
// the clip may differ from the skeleton's by a unit, a place and a turn; what was found is among
// the warnings. kInvalidArgument says which joints are missing, or where the rest pose is another
// one: such a clip is of another character.
absl::StatusOr<Motion> MotionFromClip(const JointClip& clip, const Skeleton& skeleton);

}  // namespace pleat
