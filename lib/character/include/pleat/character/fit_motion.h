// Finds the motion of a mesh sequence in terms of a trained character.
#pragma once

#include "absl/status/statusor.h"
#include "pleat/base/progress.h"
#include "pleat/character/character_model.h"
#include "pleat/character/train_character.h"
#include "pleat/mesh/mesh_sequence.h"
#include "pleat/skeleton/pose_track.h"

namespace pleat {

// Fits the poses of `model` to every frame of `sequence` exactly as its training did, so a training
// clip gives its training poses again. kInvalidArgument when the connectivity is not the model's,
// kCancelled when `progress` was cancelled.
absl::StatusOr<PoseTrack> FitMotion(const CharacterModel& model, const MeshSequence& sequence,
                                    const TrainResources& resources = {},
                                    const Progress& progress = {});

}  // namespace pleat
