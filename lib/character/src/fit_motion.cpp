#include "pleat/character/fit_motion.h"

#include "absl/strings/str_cat.h"
#include "training_steps.h"

namespace pleat {

absl::StatusOr<PoseTrack> FitMotion(const CharacterModel& model, const MeshSequence& sequence,
                                    const TrainResources& resources, const Progress& progress) {
  if (!(sequence.topology() == model.topology())) {
    return absl::InvalidArgumentError(
        absl::StrCat("'", sequence.name(), "' has ", sequence.num_vertices(), " vertices and ",
                     sequence.topology().num_faces(), " faces, the model ", model.num_vertices(),
                     " and ", model.topology().num_faces(),
                     ": poses are found only in a mesh with the model's own connectivity"));
  }
  return FitFrames(sequence, {0}, model.rig(), model.options(), resources, nullptr,
                   progress.Stage("fit", 0, 1));
}

}  // namespace pleat
