// The one door for motions: JSON, BVH, and the joints of glTF (docs/formats/motion.md).
#pragma once

#include <optional>
#include <string>

#include "absl/status/statusor.h"
#include "pleat/formats/motion_file.h"
#include "pleat/mesh/mesh_limits.h"
#include "pleat/mesh/mesh_sequence.h"
#include "pleat/skeleton/skeleton.h"

namespace pleat {

struct ReadMotionOptions {
  MeshLimits limits{};
  std::optional<FrameRate> frame_rate{};  // of glTF, in place of that of its keys
};

// Reads a motion of `skeleton`. What the bytes are counts more than the ending. Joints of BVH and
// glTF are matched by name, and how the file's skeleton was laid on the character is among the
// warnings. The errors are those of DecodeMotion and name the file; kInvalidArgument also for a
// file of another skeleton, with the joints that it lacks.
absl::StatusOr<Motion> ReadMotion(const std::string& path, const Skeleton& skeleton,
                                  const ReadMotionOptions& options = {});

// True for a file that ReadMotion is for: JSON and BVH by their endings, glTF (.glb, .gltf) when a
// skin of it has all joints of `skeleton` and something moves. Others may be mesh sequences.
bool HoldsMotion(const std::string& path, const Skeleton& skeleton,
                 const ReadMotionOptions& options = {});

}  // namespace pleat
