#include "pleat/character/training_checkpoint.h"

#include <algorithm>

#include "absl/strings/str_cat.h"
#include "pleat/base/status.h"

namespace pleat {
namespace {

absl::Status CheckRigging(const TrainingCheckpoint::Rigging& rigging, int num_vertices,
                          int num_rig_frames) {
  const Rig& rig = rigging.rig;
  if (rig.weights.num_vertices() != num_vertices || rig.rest_positions.cols() != num_vertices) {
    return absl::InvalidArgumentError(absl::StrCat("checkpoint: a rig of ",
                                                   rig.weights.num_vertices(),
                                                   " vertices; the clips have ", num_vertices));
  }
  if (rig.weights.num_joints() != rig.skeleton.num_joints() || !rig.rest_positions.allFinite()) {
    return absl::InvalidArgumentError("checkpoint: the parts of the rig do not fit together");
  }
  if (rigging.rest_frame < 0 || rigging.rest_frame >= num_rig_frames) {
    return absl::InvalidArgumentError(absl::StrCat("checkpoint: rest frame ", rigging.rest_frame,
                                                   " of a clip of ", num_rig_frames, " frames"));
  }
  const bool joints_are_known = std::ranges::all_of(rigging.locked_joints, [&](int joint) {
    return joint >= 0 && joint < rig.skeleton.num_joints();
  });
  if (!joints_are_known) {
    return absl::InvalidArgumentError("checkpoint: a locked joint that the rig does not have");
  }
  return absl::OkStatus();
}

}  // namespace

absl::Status CheckTrainingCheckpoint(const TrainingCheckpoint& checkpoint, int num_vertices,
                                     int num_frames, int num_rig_frames,
                                     const std::vector<int>& clip_starts) {
  if ((checkpoint.fit && !checkpoint.rigging) || (checkpoint.choice && !checkpoint.fit) ||
      (checkpoint.detail_model && !checkpoint.choice)) {
    return absl::InvalidArgumentError("checkpoint: a stage is there without the one before it");
  }
  if (!checkpoint.rigging) return absl::OkStatus();
  PLEAT_RETURN_IF_ERROR(CheckRigging(*checkpoint.rigging, num_vertices, num_rig_frames));
  if (!checkpoint.fit) return absl::OkStatus();
  const PoseTrack& track = checkpoint.fit->track;
  if (track.num_frames() != num_frames || track.clip_starts() != clip_starts) {
    return absl::InvalidArgumentError(absl::StrCat("checkpoint: poses of ", track.num_frames(),
                                                   " frames; the clips have ", num_frames));
  }
  PLEAT_RETURN_IF_ERROR(CheckJointCount(track, checkpoint.rigging->rig.skeleton.num_joints()));
  if (checkpoint.choice && checkpoint.choice->learner == LearnerChoice::kAuto) {
    return absl::InvalidArgumentError("checkpoint: no learner was chosen");
  }
  return absl::OkStatus();
}

}  // namespace pleat
