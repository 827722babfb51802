// Offline: turns mesh sequences into a character model (steps 3 to 7 of the data flow in
// ARCHITECTURE.md).
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "pleat/base/progress.h"
#include "pleat/character/character_model.h"
#include "pleat/character/train_options.h"
#include "pleat/character/training_checkpoint.h"
#include "pleat/mesh/mesh_sequence.h"

namespace pleat {

// Resources are not choices: they never change the result and are not stored.
struct TrainResources {
  int num_threads = 0;  // 0 = one per core
  // True: the caller has looked for frames that jump and the clips have none (FindFrameJumps), so
  // that they are not looked for again.
  bool clips_are_known_without_jumps = false;
  // Where another process that trained the same came to. Null: the training begins anew. One that
  // does not fit the clips is kInvalidArgument (CheckTrainingCheckpoint).
  const TrainingCheckpoint* resume = nullptr;
  // Receives what is finished after each stage that takes long, from the thread that computes.
  std::function<void(const TrainingCheckpoint& checkpoint)> on_checkpoint{};
};

// What a training run reports beside the model. The record of the model holds the rest.
struct TrainSummary {
  int num_components = 0;  // components of the detail basis
  int num_control_vertices = 0;
};

// Trains one character from one or more clips with the same connectivity and frame rate. The rest
// frame is a frame of the first clip. `summary` may be null. Errors: kInvalidArgument for bad
// options or clips (it names the clip and the first face that differs), kFailedPrecondition when no
// human-like rig fits or the frames of a clip jump (options.jumps), kCancelled when `progress` was
// cancelled.
absl::StatusOr<std::shared_ptr<const CharacterModel>> TrainCharacter(
    const std::vector<MeshSequence>& clips, const TrainOptions& options,
    const TrainResources& resources = {}, TrainSummary* summary = nullptr,
    const Progress& progress = {});

}  // namespace pleat
