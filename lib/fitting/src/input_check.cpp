#include "input_check.h"

#include "absl/strings/str_cat.h"

namespace pleat {

absl::Status CheckRigOfSequence(const std::string& step, const MeshSequence& sequence,
                                const Rig& rig) {
  const int num_vertices = sequence.num_vertices();
  if (rig.weights.num_vertices() == num_vertices && rig.rest_positions.cols() == num_vertices) {
    return absl::OkStatus();
  }
  return absl::InvalidArgumentError(
      absl::StrCat(step, ": the rig has ", rig.weights.num_vertices(), " skinned and ",
                   rig.rest_positions.cols(), " rest vertices, the sequence '", sequence.name(),
                   "' has ", num_vertices, "; use the rig of this mesh"));
}

absl::Status CheckTrackOfSequence(const std::string& step, const MeshSequence& sequence,
                                  const Rig& rig, const PoseTrack& track) {
  if (track.num_frames() != sequence.num_frames()) {
    return absl::InvalidArgumentError(
        absl::StrCat(step, ": the pose track has ", track.num_frames(), " frames, the sequence '",
                     sequence.name(), "' has ", sequence.num_frames()));
  }
  return CheckJointCount(track, rig.skeleton.num_joints());
}

}  // namespace pleat
