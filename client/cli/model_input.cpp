#include "cli/model_input.h"

#include <filesystem>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "cli/progress_display.h"
#include "cli/service.h"
#include "pleat/base/status.h"
#include "pleat/fitting/pose_fit.h"
#include "pleat/formats/model_file.h"

namespace pleat {

bool IsModelFile(const std::string& model) {
  std::error_code error;
  return absl::EndsWith(model, ".pleat") || std::filesystem::exists(model, error);
}

absl::StatusOr<std::shared_ptr<const CharacterModel>> LoadModel(const Session& session,
                                                                const std::string& model) {
  if (IsModelFile(model)) return ReadModelFile(model);
  PLEAT_ASSIGN_OR_RETURN(const std::unique_ptr<CharacterService> service, OpenService(session));
  PLEAT_ASSIGN_OR_RETURN(const std::string id, FindModel(*service, model));
  ProgressDisplay display(*session.err, ChooseProgressStyle(session), MonotonicSeconds);
  PLEAT_ASSIGN_OR_RETURN(
      const std::string bytes,
      service->DownloadModel(id, InterruptibleProgress(&display).Stage("download", 0, 1)));
  return DecodeModel(bytes);
}

absl::StatusOr<PoseTrack> FitMotion(const CharacterModel& model, const MeshSequence& sequence,
                                    const Session& session) {
  if (!(sequence.topology() == model.topology())) {
    return absl::InvalidArgumentError(
        absl::StrCat("'", sequence.name(), "' has ", sequence.num_vertices(), " vertices and ",
                     sequence.topology().num_faces(), " faces, the model ", model.num_vertices(),
                     " and ", model.topology().num_faces(),
                     ": poses are found only in a mesh with the model's own connectivity"));
  }
  PoseFitOptions options;
  options.method = model.options().fit == "walk" ? PoseFitMethod::kWalk : PoseFitMethod::kAllJoints;
  ProgressDisplay display(*session.err, ChooseProgressStyle(session), MonotonicSeconds);
  return FitPoses(sequence, model.rig(), options, nullptr,
                  InterruptibleProgress(&display).Stage("fit", 0, 1));
}

std::vector<std::string> JointNames(const Skeleton& skeleton) {
  std::vector<std::string> names;
  for (const Joint& joint : skeleton.joints()) names.push_back(joint.name);
  return names;
}

}  // namespace pleat
