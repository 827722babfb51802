// Training on a rig that the user brings.
#pragma once

#include <memory>
#include <vector>

#include "absl/status/statusor.h"
#include "pleat/character/train_character.h"
#include "pleat/skinning/user_rig.h"

namespace pleat {

// TrainCharacter with `rig` in place of the automatic one: its joints and names, its weights or,
// where it has none, heat weights on its rest frame. Everything after the rig is the same;
// refinement leaves its locked joints alone. The model's record has residual 0. Further errors:
// kInvalidArgument when weights or rest frame do not fit the first clip.
absl::StatusOr<std::shared_ptr<const CharacterModel>> TrainCharacterWithRig(
    const std::vector<MeshSequence>& clips, const UserRig& rig, const TrainOptions& options,
    const TrainResources& resources = {}, TrainSummary* summary = nullptr,
    const Progress& progress = {});

}  // namespace pleat
