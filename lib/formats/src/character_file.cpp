#include "pleat/formats/character_file.h"

#include "pleat/mesh/frame_rate.h"
#include "pleat/skinning/cut_influences.h"

namespace pleat {

absl::StatusOr<CharacterFile> MakeCharacterFile(const CharacterModel& model, const Motion& motion,
                                                int influences) {
  for (const double scale : motion.bone_scales) {
    if (scale == 1) continue;
    return absl::InvalidArgumentError(
        "its bone_scales stretch bones, which joints of other programs cannot; write the meshes of "
        "the frames instead, or take bone_scales out");
  }
  CharacterFile file;
  file.name = model.name();
  file.topology = model.topology();
  file.appearance = model.parts().appearance;
  file.rig = model.rig();
  file.rig.weights = CutInfluences(model.rig().weights, influences);
  file.track = motion.track;
  file.frame_rate =
      motion.track.num_frames() > 0 ? FrameRateFromFps(motion.track.fps()) : model.frame_rate();
  return file;
}

}  // namespace pleat
