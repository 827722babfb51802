// The formats in which a page takes an edited animation away.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "pleat/character/character_model.h"
#include "pleat/formats/motion_file.h"
#include "pleat/mesh/mesh_sequence.h"

namespace pleat {

// All names, as the page offers them: formats of frames, of characters and of the motion.
const std::vector<std::string>& ExportFormats();

// How the mesh of every frame is written: {"glb", ...}; null: no format of frames has this name.
using EncodeFrames = absl::StatusOr<std::string> (*)(const MeshSequence& sequence);
EncodeFrames FindFramesFormat(const std::string& name);

// "character.glb": skin, joints, motion and folds as morph targets; "character.usda": skin, joints
// and motion; "bvh": the motion. kInvalidArgument for other names, and for what the format cannot
// hold.
absl::StatusOr<std::string> EncodeCharacterAs(const std::string& name,
                                              const std::shared_ptr<const CharacterModel>& model,
                                              const Motion& motion);

}  // namespace pleat
