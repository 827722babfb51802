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

// A training with what it has finished. The shares of the stages are between those of the default
// options on a dance of 175 frames (10, 29, 3, 31, 24 and 3 % of the time) and on a skirt of 343
// (3, 18, 3, 41, 34 and 1 %).
class Training {
 public:
  Training(const TrainOptions& options, const TrainResources& resources, const Progress& progress)
      : options_(options), resources_(resources), progress_(progress) {}

  // rig: the user's; null: one is found.
  absl::StatusOr<std::shared_ptr<const CharacterModel>> Run(const TrainingFrames& frames,
                                                            const UserRig* rig,
                                                            TrainSummary* summary) {
    if (resources_.resume) done_ = *resources_.resume;
    PLEAT_RETURN_IF_ERROR(CheckTrainingCheckpoint(done_, frames.sequence.num_vertices(),
                                                  frames.sequence.num_frames(),
                                                  frames.num_rig_frames, frames.clip_starts));
    diagonal_m_ = BoundsDiagonal(frames.sequence.FrameAsDouble(0));
    PLEAT_ASSIGN_OR_RETURN(RiggedFrames rigged, RigTheFrames(frames, rig));
    PLEAT_RETURN_IF_ERROR(Fit(&rigged));
    PLEAT_ASSIGN_OR_RETURN(const LearningData data,
                           ComputeLearningData(rigged, done_.fit->track, options_, resources_,
                                               progress_.Stage("detail", .3, .33)));
    PLEAT_RETURN_IF_ERROR(Learn(data, rigged.rig));
    if (summary) {
      summary->num_components = done_.detail_model->num_components();
      summary->num_control_vertices = static_cast<int>(data.control_vertices.size());
    }
    return Assemble(rigged, data);
  }

 private:
  absl::StatusOr<RiggedFrames> RigTheFrames(const TrainingFrames& frames, const UserRig* rig) {
    if (done_.rigging) {
      const TrainingCheckpoint::Rigging& rigging = *done_.rigging;
      RiggedFrames rigged{.frames = frames,
                          .rig = rigging.rig,
                          .rig_summary = {},
                          .locked_joints = rigging.locked_joints};
      rigged.rig_summary.rest_frame = rigging.rest_frame;
      rigged.rig_summary.yaw_degrees = rigging.yaw_degrees;
      rigged.rig_summary.residual = rigging.residual;
      rigged.rig_summary.warnings = rigging.warnings;
      return rigged;
    }
    const Progress progress = progress_.Stage("rig", 0, .06);
    PLEAT_ASSIGN_OR_RETURN(RiggedFrames rigged,
                           rig ? TakeUserRig(frames, *rig, resources_, progress)
                               : RigFrames(frames, options_, resources_, progress));
    done_.rigging = {.rig = rigged.rig,
                     .rest_frame = rigged.rig_summary.rest_frame,
                     .yaw_degrees = rigged.rig_summary.yaw_degrees,
                     .residual = rigged.rig_summary.residual,
                     .warnings = rigged.rig_summary.warnings,
                     .locked_joints = rigged.locked_joints};
    HandOver();
    return rigged;
  }

  absl::Status Fit(RiggedFrames* rigged) {
    if (done_.fit) return absl::OkStatus();
    PoseFitSummary summary;
    PLEAT_ASSIGN_OR_RETURN(
        PoseTrack track,
        FitTrainingFrames(options_, resources_, rigged, &summary, progress_.Stage("fit", .06, .3)));
    done_.rigging->rig = rigged->rig;  // refined
    done_.fit = {.track = std::move(track),
                 .jitter_rad = summary.jitter_rad,
                 .unsmoothed_jitter_rad = summary.unsmoothed_jitter_rad,
                 .unsmoothed_rms_m = summary.unsmoothed_rms_m};
    HandOver();
    return absl::OkStatus();
  }

  absl::Status Learn(const LearningData& data, const Rig& rig) {
    if (!done_.choice) {
      TrainingCheckpoint::Choice choice;
      PLEAT_ASSIGN_OR_RETURN(choice.learner,
                             ChooseLearner(data, rig, options_, diagonal_m_, &choice.validation,
                                           progress_.Stage("validate", .33, .68)));
      done_.choice = std::move(choice);
      if (options_.learner == LearnerChoice::kAuto) HandOver();  // else nothing was computed
    }
    if (done_.detail_model) return absl::OkStatus();
    PLEAT_ASSIGN_OR_RETURN(done_.detail_model,
                           LearnDetails(data, rig, done_.choice->learner, options_,
                                        progress_.Stage("learn", .68, .97)));
    HandOver();
    return absl::OkStatus();
  }

  absl::StatusOr<std::shared_ptr<const CharacterModel>> Assemble(const RiggedFrames& rigged,
                                                                 const LearningData& data) const {
    PLEAT_ASSIGN_OR_RETURN(const std::shared_ptr<const CharacterModel> unmeasured,
                           AssembleModel(rigged, data, options_, done_.choice->learner,
                                         done_.detail_model, diagonal_m_));
    const TrainingCheckpoint::Fit& fit = *done_.fit;
    PLEAT_ASSIGN_OR_RETURN(TrainingRecord record,
                           MeasureReconstruction(unmeasured, rigged.frames.sequence, fit.track,
                                                 progress_.Stage("measure", .97, 1)));
    constexpr double kDegrees = 180 / std::numbers::pi;
    record.validation = done_.choice->validation;
    record.pose_jitter_degrees = kDegrees * fit.jitter_rad;
    record.unsmoothed_jitter_degrees = kDegrees * fit.unsmoothed_jitter_rad;
    record.unsmoothed_rms_percent = 100 * fit.unsmoothed_rms_m / diagonal_m_;
    return unmeasured->WithRecord(std::move(record));
  }

  void HandOver() const {
    if (resources_.on_checkpoint) resources_.on_checkpoint(done_);
  }

  const TrainOptions& options_;
  const TrainResources& resources_;
  const Progress& progress_;
  TrainingCheckpoint done_;
  double diagonal_m_ = 0;
};

// Trains with the given rig, or finds one when `rig` is null.
absl::StatusOr<std::shared_ptr<const CharacterModel>> Train(
    const std::vector<MeshSequence>& clips, const UserRig* rig, const TrainOptions& options,
    const TrainResources& resources, TrainSummary* summary, const Progress& progress) {
  PLEAT_RETURN_IF_ERROR(rig ? CheckOptionsWithRig(options) : ValidateTrainOptions(options));
  PLEAT_ASSIGN_OR_RETURN(const TrainingFrames frames, JoinClips(clips));
  if (options.jumps == JumpPolicy::kRefuse && !resources.clips_are_known_without_jumps) {
    for (const MeshSequence& clip : clips) PLEAT_RETURN_IF_ERROR(RefuseFrameJumps(clip));
  }
  // The automatic rig tries again where its first skeleton is doubtful.
  const Progress forward = progress.ForwardOnly();
  return Training(options, resources, forward).Run(frames, rig, summary);
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
