// Motions as JSON (docs/formats/motion.md). ReadMotion (motion_reader.h) reads them from files.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "pleat/mesh/mesh_limits.h"
#include "pleat/skeleton/pose_track.h"
#include "pleat/skeleton/skeleton.h"

namespace pleat {

struct Motion {
  PoseTrack track;                  // with all joints of the skeleton
  std::vector<double> bone_scales;  // J, or empty when the file has none
  // How strong the learned detail is, 0 to 2: J factors by the bones that move a vertex, and V
  // factors painted on the vertices. Empty: 1.
  std::vector<double> detail_strengths{};
  std::vector<float> vertex_strengths{};
  std::vector<std::string> warnings;  // joints left at rest, ignored fields, rescaled quaternions
};

// Reads a motion and matches its joints to those of `skeleton` by name. kInvalidArgument names the
// frame and the joint and says what is wrong there; for an unknown joint it lists the known ones.
// kResourceExhausted names the limit that the file exceeds.
absl::StatusOr<Motion> DecodeMotion(std::string_view text, const Skeleton& skeleton,
                                    const MeshLimits& limits = {});

// Writes a motion. `track` must have skeleton.num_joints() joints (asserted). bone_scales: J
// entries or empty.
std::string EncodeMotion(const Skeleton& skeleton, const PoseTrack& track,
                         const std::vector<double>& bone_scales = {});
// Does the same with everything that the motion has, and with the skeleton in its rest, which later
// edits need (DecodeMotionSkeleton).
std::string EncodeMotionWithSkeleton(const Skeleton& skeleton, const Motion& motion);
absl::Status WriteMotion(const std::string& path, const Skeleton& skeleton, const PoseTrack& track,
                         const std::vector<double>& bone_scales = {});

}  // namespace pleat
