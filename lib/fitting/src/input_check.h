// What every step of fitting asks of its input first.
#pragma once

#include <string>

#include "absl/status/status.h"
#include "pleat/mesh/mesh_sequence.h"
#include "pleat/skeleton/pose_track.h"
#include "pleat/skinning/rig.h"

namespace pleat {

// kInvalidArgument when weights or rest mesh belong to another mesh than that of `sequence`. `step`
// ("pose fit") begins the message.
absl::Status CheckRigOfSequence(const std::string& step, const MeshSequence& sequence,
                                const Rig& rig);

// kInvalidArgument unless `track` has one pose for each frame, with the joints of the rig.
absl::Status CheckTrackOfSequence(const std::string& step, const MeshSequence& sequence,
                                  const Rig& rig, const PoseTrack& track);

}  // namespace pleat
