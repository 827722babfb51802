#include "pleat/character/train_character.h"

#include <algorithm>
#include <numbers>
#include <numeric>
#include <utility>

#include "pleat/base/status.h"
#include "pleat/character/pose_evaluator.h"
#include "pleat/character/train_with_rig.h"
#include "pleat/mesh/bounds.h"
#include "pleat/mesh/frame_jumps.h"
#include "training_steps.h"

namespace pleat {
namespace {

ErrorSummary WithoutFrames(ErrorSummary summary) {
  summary.frame_mean_percent.clear();
  return summary;
}

// Says whether frame t is measured: every frame, or of thousands of frames pairs of neighbors,
// since the error of motion needs two frames in a row.
bool IsMeasured(int t, int num_frames) {
  constexpr int kMaxMeasuredFrames = 2000;
  const int period = 2 * ((num_frames + kMaxMeasuredFrames - 1) / kMaxMeasuredFrames);
  return t % period < 2;
}

// Returns the five frames with the largest mean error. frames[i]: the index, in the joined
// sequence, of the frame that entry i of frame_mean_percent belongs to.
std::vector<FrameError> WorstFrames(const std::vector<double>& frame_mean_percent,
                                    const std::vector<int>& frames, const PoseTrack& track) {
  std::vector<int> order(frame_mean_percent.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(),
                   [&](int a, int b) { return frame_mean_percent[a] > frame_mean_percent[b]; });
  std::vector<FrameError> worst;
  for (size_t i = 0; i < std::min<size_t>(5, order.size()); ++i) {
    const int t = frames[order[i]];
    const ClipRange clip = track.ClipOf(t);
    worst.push_back({clip.clip, t - clip.begin, frame_mean_percent[order[i]]});
  }
  return worst;
}

// Returns the mean error of every bone's vertices, weighted by how much the bone moves each of
// them, or 0 for a bone that moves none.
std::vector<double> JointErrors(const SkinWeights& weights, const Eigen::VectorXd& vertex_error) {
  std::vector<double> sums(weights.num_joints(), 0), totals(weights.num_joints(), 0);
  for (int v = 0; v < weights.num_vertices(); ++v) {
    const VertexInfluences& influences = weights.vertex(v);
    for (int k = 0; k < kMaxInfluences; ++k) {
      sums[influences.bones[k]] += influences.weights[k] * vertex_error[v];
      totals[influences.bones[k]] += influences.weights[k];
    }
  }
  for (size_t j = 0; j < sums.size(); ++j) sums[j] = totals[j] > 0 ? sums[j] / totals[j] : 0;
  return sums;
}

// Measures the errors of the record on the training frames: skinned only and hybrid against the
// input.
absl::StatusOr<TrainingRecord> MeasureReconstruction(
    const std::shared_ptr<const CharacterModel>& model, const MeshSequence& sequence,
    const PoseTrack& track, const Progress& progress) {
  TrainingRecord record = model->record();
  const SkinWeights& weights = model->rig().weights;
  Eigen::VectorXd vertex_error = Eigen::VectorXd::Zero(sequence.num_vertices());  // summed, meters
  ErrorAccumulator fit(record.diagonal_m), reconstruction(record.diagonal_m);
  PoseEvaluator evaluator(model);
  EvaluatedFrame skinned;
  std::vector<int> measured;
  PLEAT_RETURN_IF_ERROR(evaluator.EvaluateClip(
      track, {},
      [&](int t, const EvaluatedFrame& hybrid) {
        if (!IsMeasured(t, track.num_frames())) return absl::OkStatus();
        const bool follows = !measured.empty() && measured.back() == t - 1 && !track.StartsClip(t);
        measured.push_back(t);
        const Eigen::Matrix3Xd truth = sequence.FrameAsDouble(t);
        reconstruction.AddFrame(hybrid.positions.cast<double>(), truth, follows);
        PLEAT_RETURN_IF_ERROR(evaluator.EvaluateSkinned(track.pose(t), {}, &skinned));
        fit.AddFrame(skinned.positions.cast<double>(), truth, follows);
        vertex_error += (skinned.positions.cast<double>() - truth).colwise().norm().transpose();
        return absl::OkStatus();
      },
      progress));
  ErrorSummary fit_summary = fit.Summarize();
  record.worst_frames = WorstFrames(fit_summary.frame_mean_percent, measured, track);
  record.joint_fit_percent =
      JointErrors(weights, 100 / (record.diagonal_m * double(measured.size())) * vertex_error);
  record.fit = WithoutFrames(std::move(fit_summary));
  record.reconstruction = WithoutFrames(reconstruction.Summarize());
  return record;
}

// Trains with the given rig, or finds one when `rig` is null.
absl::StatusOr<std::shared_ptr<const CharacterModel>> Train(
    const std::vector<MeshSequence>& clips, const UserRig* rig, const TrainOptions& options,
    const TrainResources& resources, TrainSummary* summary, const Progress& progress) {
  PLEAT_RETURN_IF_ERROR(rig ? CheckOptionsWithRig(options) : ValidateTrainOptions(options));
  PLEAT_ASSIGN_OR_RETURN(const TrainingFrames frames, JoinClips(clips));
  if (options.jumps == JumpPolicy::kRefuse && !resources.clips_are_known_without_jumps) {
    for (const MeshSequence& clip : clips) PLEAT_RETURN_IF_ERROR(RefuseFrameJumps(clip));
  }
  const double diagonal_m = BoundsDiagonal(frames.sequence.FrameAsDouble(0));

  // The shares are between those of the default options on a dance of 175 frames (10, 29, 3, 31, 24
  // and 3 % of the time) and on a skirt of 343 (3, 18, 3, 41, 34 and 1 %).
  const Progress rigging = progress.Stage("rig", 0, .06);
  PLEAT_ASSIGN_OR_RETURN(RiggedFrames rigged, rig ? TakeUserRig(frames, *rig, resources, rigging)
                                                  : RigFrames(frames, options, resources, rigging));
  PoseFitSummary fit;
  PLEAT_ASSIGN_OR_RETURN(const PoseTrack track, FitTrainingFrames(options, resources, &rigged, &fit,
                                                                  progress.Stage("fit", .06, .3)));
  PLEAT_ASSIGN_OR_RETURN(
      const LearningData data,
      ComputeLearningData(rigged, track, options, resources, progress.Stage("detail", .3, .33)));
  LearnerValidation validation;
  PLEAT_ASSIGN_OR_RETURN(const LearnerChoice learner,
                         ChooseLearner(data, rigged.rig, options, diagonal_m, &validation,
                                       progress.Stage("validate", .33, .68)));
  PLEAT_ASSIGN_OR_RETURN(
      const std::shared_ptr<const DetailModel> detail_model,
      LearnDetails(data, rigged.rig, learner, options, progress.Stage("learn", .68, .97)));

  PLEAT_ASSIGN_OR_RETURN(const std::shared_ptr<const CharacterModel> unmeasured,
                         AssembleModel(rigged, data, options, learner, detail_model, diagonal_m));
  PLEAT_ASSIGN_OR_RETURN(
      TrainingRecord record,
      MeasureReconstruction(unmeasured, frames.sequence, track, progress.Stage("measure", .97, 1)));
  constexpr double kDegrees = 180 / std::numbers::pi;
  record.validation = std::move(validation);
  record.pose_jitter_degrees = kDegrees * fit.jitter_rad;
  record.unsmoothed_jitter_degrees = kDegrees * fit.unsmoothed_jitter_rad;
  record.unsmoothed_rms_percent = 100 * fit.unsmoothed_rms_m / diagonal_m;
  if (summary) {
    summary->num_components = detail_model->num_components();
    summary->num_control_vertices = static_cast<int>(data.control_vertices.size());
  }
  return unmeasured->WithRecord(std::move(record));
}

}  // namespace

absl::StatusOr<std::shared_ptr<const CharacterModel>> TrainCharacter(
    const std::vector<MeshSequence>& clips, const TrainOptions& options,
    const TrainResources& resources, TrainSummary* summary, const Progress& progress) {
  return Train(clips, nullptr, options, resources, summary, progress);
}

absl::Status CheckOptionsWithRig(const TrainOptions& options) {
  PLEAT_RETURN_IF_ERROR(ValidateTrainOptions(options));
  if (options.placed_joints.empty()) return absl::OkStatus();
  return absl::InvalidArgumentError(
      "option placed_joints: they are joints of the automatic rig, and the rig is your own; move "
      "its joints in the rig file instead");
}

absl::StatusOr<std::shared_ptr<const CharacterModel>> TrainCharacterWithRig(
    const std::vector<MeshSequence>& clips, const UserRig& rig, const TrainOptions& options,
    const TrainResources& resources, TrainSummary* summary, const Progress& progress) {
  return Train(clips, &rig, options, resources, summary, progress);
}

}  // namespace pleat
