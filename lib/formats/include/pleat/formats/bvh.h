// Biovision hierarchies (.bvh): the motion of a skeleton as text (docs/formats/bvh.md).
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "pleat/formats/joint_clip.h"
#include "pleat/mesh/mesh_limits.h"

namespace pleat {

struct BvhFile {
  JointClip clip;                     // in the units of the file
  std::vector<std::string> warnings;  // wrong counts of frames, a last frame that is cut off, ...
};

// Reads any hierarchy with any channels from hostile text. kInvalidArgument says what is wrong and
// in which line, kResourceExhausted names the limit that is exceeded.
absl::StatusOr<BvhFile> DecodeBvh(std::string_view text, const MeshLimits& limits = {});

// True for text that begins like a BVH file.
bool IsBvhText(std::string_view bytes);

struct BvhOptions {
  double unit_m = .01;  // meters per unit of the file; packages expect centimeters
};

// Writes a clip in meters, whose first joint is its only root. The root has six channels and all
// others three, Z X Y. A root lies at the origin at rest, since programs disagree whether its
// offset is added to its position.
std::string EncodeBvh(const JointClip& clip, const BvhOptions& options = {});
absl::Status WriteBvh(const std::string& path, const JointClip& clip,
                      const BvhOptions& options = {});

}  // namespace pleat
