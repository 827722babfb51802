// The steps that one evaluation and the variants of an experiment share.
#pragma once

#include <map>
#include <optional>
#include <string>

#include "absl/status/statusor.h"
#include "pleat/base/progress.h"
#include "pleat/character/evaluate.h"
#include "prediction_errors.h"
#include "training_steps.h"

namespace pleat {

// What does not depend on how details are learned: the rig and the poses.
struct EvaluationSetup {
  RiggedFrames rigged;                    // training frames and the rig found on them
  PoseTrack train_track;                  // their poses
  TestSide test;                          // poses fitted with that rig
  double diagonal_m = 0;                  // bounding-box diagonal of frame 0, meters
  std::map<std::string, double> seconds;  // "rig", "fit"
};
// Checks the options and finds rig and poses, as EvaluateCharacter describes.
absl::StatusOr<EvaluationSetup> PrepareEvaluation(const MeshSequence& sequence,
                                                  const std::optional<MeshSequence>& test_sequence,
                                                  const EvaluateOptions& options,
                                                  const Progress& progress);

// Learns from the training frames and measures the test frames. `train` may differ from the options
// of the setup in what is learned from rig and poses, but not in how those are found.
absl::StatusOr<EvaluateReport> EvaluateLearning(const EvaluationSetup& setup,
                                                const TrainOptions& train,
                                                const EvaluateOptions& options,
                                                const Progress& progress);

}  // namespace pleat
