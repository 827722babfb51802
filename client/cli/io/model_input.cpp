#include "cli/io/model_input.h"

#include <filesystem>

#include "absl/strings/match.h"
#include "cli/io/frame_rate.h"
#include "cli/io/input.h"
#include "cli/service.h"
#include "cli/show/progress_display.h"
#include "pleat/base/status.h"
#include "pleat/character/fit_motion.h"
#include "pleat/formats/model_file.h"
#include "pleat/formats/motion_reader.h"

namespace pleat {

bool IsModelFile(const std::string& model) {
  std::error_code error;
  return absl::EndsWith(model, ".pleat") || std::filesystem::exists(model, error);
}

absl::StatusOr<std::shared_ptr<const CharacterModel>> LoadModel(const Session& session,
                                                                const std::string& model) {
  if (IsModelFile(model)) return ReadModelFile(model);
  PLEAT_ASSIGN_OR_RETURN(const std::unique_ptr<CharacterService> service, OpenService(session));
  PLEAT_ASSIGN_OR_RETURN(const std::string id, FindModel(service->models(), model));
  ProgressDisplay display(*session.err, ChooseProgressStyle(session), MonotonicSeconds);
  PLEAT_ASSIGN_OR_RETURN(
      const std::string bytes,
      service->models().Download(id, InterruptibleProgress(&display).Stage("download", 0, 1)));
  return DecodeModel(bytes);
}

absl::StatusOr<PoseTrack> FitMotionWithProgress(const CharacterModel& model,
                                                const MeshSequence& sequence,
                                                const Session& session) {
  ProgressDisplay display(*session.err, ChooseProgressStyle(session), MonotonicSeconds);
  return FitMotion(model, sequence, {}, InterruptibleProgress(&display));
}

absl::StatusOr<Motion> LoadMotion(const std::string& source, const std::string& fps,
                                  const CharacterModel& model, const Session& session) {
  ReadMotionOptions options;
  if (!fps.empty()) {
    PLEAT_ASSIGN_OR_RETURN(options.frame_rate, ParseFrameRate(fps));
  }
  if (HoldsMotion(source, model.skeleton(), options)) {
    return ReadMotion(source, model.skeleton(), options);
  }
  PLEAT_ASSIGN_OR_RETURN(const MeshSequence sequence, ReadInput(session, source, fps));
  Motion motion;
  PLEAT_ASSIGN_OR_RETURN(motion.track, FitMotionWithProgress(model, sequence, session));
  return motion;
}

std::vector<std::string> JointNames(const Skeleton& skeleton) {
  std::vector<std::string> names;
  for (const Joint& joint : skeleton.joints()) names.push_back(joint.name);
  return names;
}

}  // namespace pleat
