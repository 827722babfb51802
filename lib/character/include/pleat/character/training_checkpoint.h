// What a training has finished, from which another process goes on.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "pleat/character/character_model.h"
#include "pleat/character/option_choices.h"
#include "pleat/learner/detail_model.h"
#include "pleat/skeleton/pose_track.h"
#include "pleat/skinning/rig.h"

namespace pleat {

// The results of the stages that take long; what lies between them is computed again. A training
// that goes on from any checkpoint of the same clips, rig and options ends with the same bytes as
// one that was never interrupted. Each part is there only with those before it.
struct TrainingCheckpoint {
  // Stage "rig": the automatic rig, or the user's with its weights.
  struct Rigging {
    Rig rig;  // V vertices, J joints
    int rest_frame = 0;
    double yaw_degrees = 0;
    double residual = 0;
    std::vector<std::string> warnings;
    std::vector<int> locked_joints;
  };
  // Stage "fit". The rig of Rigging is the refined one from here on.
  struct Fit {
    PoseTrack track;  // T poses of J joints
    double jitter_rad = 0, unsmoothed_jitter_rad = 0, unsmoothed_rms_m = 0;
  };
  // Stage "validate".
  struct Choice {
    LearnerChoice learner = LearnerChoice::kGp;  // not kAuto
    LearnerValidation validation;
  };

  std::optional<Rigging> rigging;
  std::optional<Fit> fit;
  std::optional<Choice> choice;
  std::shared_ptr<const DetailModel> detail_model;  // stage "learn"; null: not finished
};

// OK when the parts fit together and belong to clips of so many vertices and frames with these clip
// starts, of which the first clip has `num_rig_frames`. Else kInvalidArgument says what does not
// fit. Whether they came from these clips nobody can see here.
absl::Status CheckTrainingCheckpoint(const TrainingCheckpoint& checkpoint, int num_vertices,
                                     int num_frames, int num_rig_frames,
                                     const std::vector<int>& clip_starts);

}  // namespace pleat
