// The motion of a skeleton of any kind, from BVH and glTF, for retargeting.
#pragma once

#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "pleat/formats/joint_clip.h"
#include "pleat/formats/motion_reader.h"

namespace pleat {

struct JointClipFile {
  JointClip clip;                     // in the units of the file
  std::vector<std::string> warnings;  // of the reader: wrong counts of frames, cut off frames, ...
};

// Reads all joints of a BVH, or those of the skin of a glTF with the most joints. The errors are
// those of the two readers and name the file; kInvalidArgument also for other files.
absl::StatusOr<JointClipFile> ReadJointClip(const std::string& path,
                                            const ReadMotionOptions& options = {});

}  // namespace pleat
