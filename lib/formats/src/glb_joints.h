// The motion of the joints of a glTF skin.
#pragma once

#include <optional>
#include <string_view>

#include "absl/status/statusor.h"
#include "glb_frames.h"
#include "pleat/formats/joint_clip.h"
#include "pleat/mesh/mesh_limits.h"
#include "pleat/skeleton/skeleton.h"

namespace pleat {

// Reads the skin of a hostile GLB that has the joints of `skeleton`, by name. Its rest pose is that
// of the inverse bind matrices, and its motion that of the nodes in the first animation; without an
// animation the clip has one frame. None when no skin has all of the joints. The errors are those
// of DecodeRigGlb.
absl::StatusOr<std::optional<JointClip>> DecodeGlbJoints(std::string_view bytes,
                                                         const Skeleton& skeleton,
                                                         const std::optional<FrameRate>& frame_rate,
                                                         const MeshLimits& limits,
                                                         InputReport* report);

// Does the same with the skin that has the most joints, whatever they are called.
absl::StatusOr<std::optional<JointClip>> DecodeLargestGlbSkin(
    std::string_view bytes, const std::optional<FrameRate>& frame_rate, const MeshLimits& limits,
    InputReport* report);

}  // namespace pleat
