#include "pleat/character/evaluate.h"

#include <algorithm>
#include <memory>
#include <utility>

#include "absl/strings/str_cat.h"
#include "baselines.h"
#include "option_values.h"
#include "pleat/base/status.h"
#include "pleat/character/pose_evaluator.h"
#include "pleat/mesh/bounds.h"
#include "pleat/skeleton/pose_history.h"
#include "training_steps.h"

namespace pleat {
namespace {

// The training side of the split: the frames, with a clip start wherever one is missing before;
// or all frames of several clips.
absl::StatusOr<TrainingFrames> TrainingSide(const MeshSequence& sequence,
                                            const std::vector<int>& frames,
                                            const std::vector<MeshSequence>& more_clips) {
  if (!more_clips.empty()) {
    std::vector<MeshSequence> clips = {sequence};
    clips.insert(clips.end(), more_clips.begin(), more_clips.end());
    return JoinClips(clips);
  }
  std::vector<int> clip_starts;
  for (size_t i = 0; i < frames.size(); ++i) {
    if (i == 0 || frames[i] != frames[i - 1] + 1) clip_starts.push_back(static_cast<int>(i));
  }
  const int count = static_cast<int>(frames.size());
  return TrainingFrames{sequence.Subset(frames), std::move(clip_starts), count, frames};
}

// Everything the comparison needs for one test frame at a time.
struct TestSide {
  MeshSequence sequence;    // the whole clip that holds the test frames
  PoseTrack track;          // its poses, fitted with the trained rig
  std::vector<int> frames;  // test frames
};

// Calls `predict` for every test frame and collects the errors.
absl::StatusOr<ErrorSummary> MeasureFrames(
    const TestSide& test, double diagonal_m, const Progress& progress,
    const std::function<absl::Status(int t, Eigen::Matrix3Xf* positions)>& predict) {
  ErrorAccumulator errors(diagonal_m);
  Eigen::Matrix3Xf positions;
  for (size_t i = 0; i < test.frames.size(); ++i) {
    const int t = test.frames[i];
    PLEAT_RETURN_IF_ERROR(predict(t, &positions));
    errors.AddFrame(positions.cast<double>(), test.sequence.FrameAsDouble(t),
                    i > 0 && test.frames[i - 1] == t - 1);
    PLEAT_RETURN_IF_ERROR(progress.Report((i + 1.0) / test.frames.size()));
  }
  return errors.Summarize();
}

absl::StatusOr<ErrorSummary> MeasureModel(const std::shared_ptr<const CharacterModel>& model,
                                          const TestSide& test, double diagonal_m,
                                          bool skinned_only, const Progress& progress) {
  PoseEvaluator evaluator(model);
  PoseHistory history(test.track, model->frame_rate().fps(), model->options().history);
  std::vector<const Pose*> poses;
  EvaluatedFrame frame;
  return MeasureFrames(test, diagonal_m, progress, [&](int t, Eigen::Matrix3Xf* positions) {
    history.At(t, &poses);
    PLEAT_RETURN_IF_ERROR(skinned_only ? evaluator.EvaluateSkinned(*poses[0], {}, &frame)
                                       : evaluator.Evaluate(poses, {}, &frame));
    positions->swap(frame.positions);
    return absl::OkStatus();
  });
}

// A baseline predicts control details; the rest of the way is the model's own.
absl::StatusOr<ErrorSummary> MeasureBaseline(const DetailPredictor& predictor,
                                             const CharacterModel& model, const TestSide& test,
                                             double diagonal_m, const Progress& progress) {
  PoseHistory history(test.track, model.frame_rate().fps(), model.options().history);
  std::vector<const Pose*> poses;
  Eigen::VectorXd features(model.features().num_features());
  BoneTransforms transforms;
  Eigen::Matrix3Xd base;
  std::vector<Eigen::Quaterniond> rotations;
  std::vector<int> all_vertices(model.num_vertices());
  for (int v = 0; v < model.num_vertices(); ++v) all_vertices[v] = v;
  return MeasureFrames(test, diagonal_m, progress, [&](int t, Eigen::Matrix3Xf* positions) {
    history.At(t, &poses);
    model.features().ComputeRow(poses, features);
    Eigen::VectorXf details = predictor(features).cast<float>();
    if (model.parts().upsampler) {
      const Eigen::MatrixXf xyz = details.reshaped(3, details.size() / 3);
      const Eigen::MatrixXf full = model.parts().upsampler->matrix() * xyz.transpose();
      details = full.transpose().reshaped();
    }
    ComputeBoneTransforms(model.skeleton(), *poses[0], {}, &transforms);
    ComputeDetailBase(DetailBaseOf(model.options()), model.rig(), transforms, &base);
    ComputeDetailRotations(DetailAxesOf(model.options()), model.rig().weights, all_vertices,
                           transforms, &rotations);
    ApplyDetails(base, rotations, details, &base);
    *positions = base.cast<float>();
    return absl::OkStatus();
  });
}

// Seconds since the last lap, by the caller's clock.
class LapTimer {
 public:
  explicit LapTimer(const std::function<double()>& clock) : clock_(clock), last_(Now()) {}
  double Lap() {
    const double now = Now();
    return now - std::exchange(last_, now);
  }

 private:
  double Now() const { return clock_ ? clock_() : 0; }
  const std::function<double()>& clock_;
  double last_;
};

// The learners to measure: those asked for and the chosen one, each once.
std::vector<std::string> LearnersToMeasure(const EvaluateOptions& options,
                                           const std::string& chosen) {
  std::vector<std::string> learners = options.learners;
  learners.push_back(chosen);
  std::sort(learners.begin(), learners.end());
  learners.erase(std::unique(learners.begin(), learners.end()), learners.end());
  return learners;
}

absl::Status CheckTestSequence(const MeshSequence& sequence,
                               const std::optional<MeshSequence>& test_sequence,
                               const EvaluateOptions& options) {
  const EvaluationProtocol protocol = options.protocol;
  if (protocol != EvaluationProtocol::kCross && !options.more_training_clips.empty()) {
    return absl::InvalidArgumentError(
        absl::StrCat("protocol ", EvaluationProtocolName(protocol),
                     " splits one clip; several training clips are for protocol cross"));
  }
  if ((protocol == EvaluationProtocol::kCross) != test_sequence.has_value()) {
    return absl::InvalidArgumentError(
        protocol == EvaluationProtocol::kCross
            ? "protocol cross needs a second clip to test on"
            : absl::StrCat("protocol ", EvaluationProtocolName(protocol),
                           " takes one clip; a second is for protocol cross"));
  }
  if (test_sequence && !(test_sequence->topology() == sequence.topology())) {
    return absl::InvalidArgumentError(
        absl::StrCat("the test clip '", test_sequence->name(),
                     "' has another connectivity than the training clip"));
  }
  return absl::OkStatus();
}

using ModelsByLearner = std::map<std::string, std::shared_ptr<const CharacterModel>>;

absl::StatusOr<ModelsByLearner> LearnModels(const RiggedFrames& rigged, const LearningData& data,
                                            const std::vector<std::string>& learners,
                                            const TrainOptions& options, double diagonal_m,
                                            const Progress& progress) {
  ModelsByLearner models;
  for (size_t i = 0; i < learners.size(); ++i) {
    const double begin = static_cast<double>(i) / static_cast<double>(learners.size());
    const double end = static_cast<double>(i + 1) / static_cast<double>(learners.size());
    PLEAT_ASSIGN_OR_RETURN(
        const std::shared_ptr<const DetailModel> detail_model,
        LearnDetails(data, learners[i], options, progress.Stage("learn", begin, end)));
    PLEAT_ASSIGN_OR_RETURN(models[learners[i]], AssembleModel(rigged, data, options, learners[i],
                                                              detail_model, diagonal_m));
  }
  return models;
}

// Fills the report's skinned, learners and baselines.
absl::Status MeasureAll(const ModelsByLearner& models,
                        const std::map<std::string, DetailPredictor>& baselines,
                        const TestSide& test, const Progress& progress, EvaluateReport* report) {
  const std::shared_ptr<const CharacterModel>& any_model = models.begin()->second;
  PLEAT_ASSIGN_OR_RETURN(report->skinned,
                         MeasureModel(any_model, test, report->diagonal_m, true, progress));
  for (const auto& [name, model] : models) {
    PLEAT_ASSIGN_OR_RETURN(report->learners[name],
                           MeasureModel(model, test, report->diagonal_m, false, progress));
  }
  for (const auto& [name, predictor] : baselines) {
    PLEAT_ASSIGN_OR_RETURN(report->baselines[name], MeasureBaseline(predictor, *any_model, test,
                                                                    report->diagonal_m, progress));
  }
  return absl::OkStatus();
}

}  // namespace

absl::StatusOr<EvaluateReport> EvaluateCharacter(const MeshSequence& sequence,
                                                 const std::optional<MeshSequence>& test_sequence,
                                                 const EvaluateOptions& options,
                                                 const Progress& progress) {
  PLEAT_RETURN_IF_ERROR(ValidateTrainOptions(options.train));
  PLEAT_RETURN_IF_ERROR(CheckTestSequence(sequence, test_sequence, options));
  PLEAT_ASSIGN_OR_RETURN(FrameSplit split, SplitFrames(options.protocol, sequence.num_frames()));
  EvaluateReport report;
  report.protocol = EvaluationProtocolName(options.protocol);
  report.options = options.train;
  report.diagonal_m = BoundsDiagonal(sequence.FrameAsDouble(0));
  LapTimer timer(options.clock_seconds);

  PLEAT_ASSIGN_OR_RETURN(const TrainingFrames frames,
                         TrainingSide(sequence, split.train, options.more_training_clips));
  PLEAT_ASSIGN_OR_RETURN(RiggedFrames rigged, RigFrames(frames, options.train, options.resources,
                                                        progress.Stage("rig", 0, .15)));
  report.seconds["rig"] = timer.Lap();

  PLEAT_ASSIGN_OR_RETURN(const PoseTrack train_track,
                         FitTrainingFrames(options.train, options.resources, &rigged, nullptr,
                                           progress.Stage("fit", .15, .25)));
  TestSide test{test_sequence ? *test_sequence : sequence, {}, std::move(split.test)};
  PLEAT_ASSIGN_OR_RETURN(test.track,
                         FitFrames(test.sequence, {0}, rigged.rig, options.train, options.resources,
                                   nullptr, progress.Stage("fit", .25, .35)));
  if (test_sequence) {
    for (int t = 0; t < test.sequence.num_frames(); ++t) test.frames.push_back(t);
  }
  report.seconds["fit"] = timer.Lap();

  PLEAT_ASSIGN_OR_RETURN(const LearningData data,
                         ComputeLearningData(rigged, train_track, options.train, options.resources,
                                             progress.Stage("detail", .35, .4)));
  PLEAT_ASSIGN_OR_RETURN(report.learner,
                         ChooseLearner(data, options.train, report.diagonal_m, nullptr,
                                       progress.Stage("validate", .4, .5)));
  PLEAT_ASSIGN_OR_RETURN(
      const ModelsByLearner models,
      LearnModels(rigged, data, LearnersToMeasure(options, report.learner), options.train,
                  report.diagonal_m, progress.Stage("learn", .5, .7)));
  PLEAT_ASSIGN_OR_RETURN(const auto baselines, TrainBaselines(data));
  report.seconds["learn"] = timer.Lap();
  PLEAT_RETURN_IF_ERROR(
      MeasureAll(models, baselines, test, progress.Stage("predict", .7, 1), &report));
  report.hybrid = report.learners[report.learner];
  report.seconds["predict"] = timer.Lap();
  report.num_train_frames = frames.sequence.num_frames();
  report.num_test_frames = static_cast<int>(test.frames.size());
  report.test_frames = std::move(test.frames);
  return report;
}

}  // namespace pleat
