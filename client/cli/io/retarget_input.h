// Clips of other skeletons as motions of a character.
#pragma once

#include <optional>
#include <string>

#include "absl/status/statusor.h"
#include "cli/session.h"
#include "cli/show/retarget_report.h"
#include "pleat/character/character_model.h"
#include "pleat/formats/motion_file.h"

namespace pleat {

struct RetargetInput {
  std::string source;  // .bvh, .glb or .gltf
  std::string map;     // a joint map (.json); empty: the default one
  std::string fps;     // of glTF, in place of that of its keys; may be empty
  bool clean_feet = false;
  bool required = false;  // a clip that has the character's own joints is retargeted too
};

// Retargets a clip whose joints are not those of the character. None for a source that is read as a
// motion of the character itself or as a mesh sequence. Warnings are in the motion.
absl::StatusOr<std::optional<Motion>> RetargetForeignClip(const RetargetInput& input,
                                                          const CharacterModel& model,
                                                          RetargetSummary* summary);

}  // namespace pleat
