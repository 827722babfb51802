#include "pleat/character/train_character.h"

#include <utility>

#include "pleat/base/status.h"
#include "pleat/character/pose_evaluator.h"
#include "pleat/mesh/bounds.h"
#include "training_steps.h"

namespace pleat {
namespace {

ErrorSummary WithoutFrames(ErrorSummary summary) {
  summary.frame_mean_percent.clear();
  return summary;
}

// The errors of the record: skinned only and hybrid against the input.
absl::Status MeasureReconstruction(std::shared_ptr<const CharacterModel> model,
                                   const MeshSequence& sequence, const PoseTrack& track,
                                   TrainingRecord* record, const Progress& progress) {
  ErrorAccumulator fit(record->diagonal_m), reconstruction(record->diagonal_m);
  PoseEvaluator evaluator(std::move(model));
  EvaluatedFrame skinned;
  size_t clip = 0;
  PLEAT_RETURN_IF_ERROR(evaluator.EvaluateClip(
      track, {},
      [&](int t, const EvaluatedFrame& hybrid) {
        const bool starts_clip =
            clip < track.clip_starts.size() && track.clip_starts[clip] == t && ++clip;
        const Eigen::Matrix3Xd truth = sequence.FrameAsDouble(t);
        reconstruction.AddFrame(hybrid.positions.cast<double>(), truth, !starts_clip);
        PLEAT_RETURN_IF_ERROR(evaluator.EvaluateSkinned(track.poses[t], {}, &skinned));
        fit.AddFrame(skinned.positions.cast<double>(), truth, !starts_clip);
        return absl::OkStatus();
      },
      progress));
  record->fit = WithoutFrames(fit.Summarize());
  record->reconstruction = WithoutFrames(reconstruction.Summarize());
  return absl::OkStatus();
}

}  // namespace

absl::StatusOr<std::shared_ptr<const CharacterModel>> TrainCharacter(
    const std::vector<MeshSequence>& clips, const TrainOptions& options,
    const TrainResources& resources, TrainSummary* summary, const Progress& progress) {
  PLEAT_RETURN_IF_ERROR(ValidateTrainOptions(options));
  PLEAT_ASSIGN_OR_RETURN(const TrainingFrames frames, JoinClips(clips));
  TrainingRecord record;
  record.diagonal_m = BoundsDiagonal(frames.sequence.FrameAsDouble(0));

  PLEAT_ASSIGN_OR_RETURN(RiggedFrames rigged,
                         RigFrames(frames, options, resources, progress.Stage("rig", 0, .25)));
  PLEAT_ASSIGN_OR_RETURN(const PoseTrack track, FitTrainingFrames(options, resources, &rigged,
                                                                  progress.Stage("fit", .25, .45)));
  PLEAT_ASSIGN_OR_RETURN(
      const LearningData data,
      ComputeLearningData(rigged, track, options, resources, progress.Stage("detail", .45, .5)));
  std::map<std::string, double> validation;
  PLEAT_ASSIGN_OR_RETURN(const std::string learner,
                         ChooseLearner(data, options, record.diagonal_m, &validation,
                                       progress.Stage("validate", .5, .75)));
  PLEAT_ASSIGN_OR_RETURN(const std::shared_ptr<const DetailModel> detail_model,
                         LearnDetails(data, learner, options, progress.Stage("learn", .75, .95)));

  // The record belongs to the model and the model to the record's errors: measure on a first copy.
  PLEAT_ASSIGN_OR_RETURN(const std::shared_ptr<const CharacterModel> draft,
                         AssembleModel(rigged, data, options, learner, detail_model, record));
  PLEAT_RETURN_IF_ERROR(MeasureReconstruction(draft, frames.sequence, track, &record,
                                              progress.Stage("measure", .95, 1)));
  if (summary) {
    summary->validation_mean_percent = std::move(validation);
    summary->num_components = static_cast<int>(detail_model->basis().cols());
    summary->num_control_vertices = static_cast<int>(data.control_vertices.size());
  }
  return AssembleModel(rigged, data, options, learner, detail_model, record);
}

}  // namespace pleat
