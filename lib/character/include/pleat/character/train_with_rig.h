// Training with a rig that the user brings.
#pragma once

#include <memory>
#include <vector>

#include "absl/status/statusor.h"
#include "pleat/character/train_character.h"
#include "pleat/skinning/user_rig.h"

namespace pleat {

// Checks the options of a training with the user's own rig: those of ValidateTrainOptions, and that
// none places joints of the automatic one.
absl::Status CheckOptionsWithRig(const TrainOptions& options);

// Does the same as TrainCharacter with `rig` in place of the automatic one: with its joints and
// their names, and with its weights or, where it has none, heat weights on its rest frame.
// Everything after the rig is the same, except that refinement leaves its locked joints alone. The
// rig_residual of the record is 0. Another error is kInvalidArgument when weights or rest frame do
// not fit the first clip.
absl::StatusOr<std::shared_ptr<const CharacterModel>> TrainCharacterWithRig(
    const std::vector<MeshSequence>& clips, const UserRig& rig, const TrainOptions& options,
    const TrainResources& resources = {}, TrainSummary* summary = nullptr,
    const Progress& progress = {});

}  // namespace pleat
