#include "pleat/character/evaluate.h"

#include <algorithm>
#include <memory>
#include <utility>

#include "absl/strings/str_cat.h"
#include "baselines.h"
#include "evaluation_steps.h"
#include "pleat/base/status.h"
#include "pleat/mesh/bounds.h"
#include "prediction_errors.h"
#include "training_steps.h"

namespace pleat {
namespace {

// Returns the training side of the split: the given frames, with a clip start wherever the frame
// before is missing, or all frames of several clips.
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

// Measures laps by the caller's clock; without a clock every lap takes 0 seconds.
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

// Returns the learners that are asked for and the chosen one, each once. The order by name puts gp
// before regional, as LearnModels requires.
std::vector<LearnerChoice> LearnersToMeasure(const EvaluateOptions& options, LearnerChoice chosen) {
  std::vector<LearnerChoice> learners = options.learners;
  learners.push_back(chosen);
  std::sort(learners.begin(), learners.end(),
            [](LearnerChoice a, LearnerChoice b) { return ChoiceName(a) < ChoiceName(b); });
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

// Trains one model for each of `learners`, which must be different. When gp comes before regional,
// its Gaussian process is trained once for both.
absl::StatusOr<ModelsByLearner> LearnModels(const RiggedFrames& rigged, const LearningData& data,
                                            const std::vector<LearnerChoice>& learners,
                                            const TrainOptions& options, double diagonal_m,
                                            const Progress& progress) {
  ModelsByLearner models;
  DirectGp direct_gp;
  for (size_t i = 0; i < learners.size(); ++i) {
    const double begin = static_cast<double>(i) / static_cast<double>(learners.size());
    const double end = static_cast<double>(i + 1) / static_cast<double>(learners.size());
    PLEAT_ASSIGN_OR_RETURN(const std::shared_ptr<const DetailModel> detail_model,
                           LearnDetails(data, rigged.rig, learners[i], options,
                                        progress.Stage("learn", begin, end), &direct_gp));
    PLEAT_ASSIGN_OR_RETURN(
        models[ChoiceName(learners[i])],
        AssembleModel(rigged, data, options, learners[i], detail_model, diagonal_m));
  }
  return models;
}

// Fills in the errors of the skinned rig, of all learners and of the baselines. Any model serves
// for the first and the last: they differ in the learner only.
absl::Status MeasureAll(const ModelsByLearner& models,
                        const std::map<std::string, DetailPredictor>& baselines,
                        const TestSide& test, const Progress& progress, EvaluateReport* report) {
  const std::shared_ptr<const CharacterModel>& any_model = models.begin()->second;
  const double num_steps = 1.0 + double(models.size()) + double(baselines.size());
  int step = 0;
  const auto next = [&] {
    const int begin = step++;
    return progress.Stage("predict", begin / num_steps, step / num_steps);
  };
  PLEAT_ASSIGN_OR_RETURN(report->skinned,
                         MeasureModel(any_model, test, report->diagonal_m, true, next()));
  for (const auto& [name, model] : models) {
    PLEAT_ASSIGN_OR_RETURN(report->learners[name],
                           MeasureModel(model, test, report->diagonal_m, false, next()));
  }
  for (const auto& [name, predictor] : baselines) {
    PLEAT_ASSIGN_OR_RETURN(report->baselines[name], MeasureBaseline(predictor, *any_model, test,
                                                                    report->diagonal_m, next()));
  }
  return absl::OkStatus();
}

}  // namespace

absl::StatusOr<EvaluationSetup> PrepareEvaluation(const MeshSequence& sequence,
                                                  const std::optional<MeshSequence>& test_sequence,
                                                  const EvaluateOptions& options,
                                                  const Progress& progress) {
  PLEAT_RETURN_IF_ERROR(ValidateTrainOptions(options.train));
  if (std::count(options.learners.begin(), options.learners.end(), LearnerChoice::kAuto) > 0) {
    return absl::InvalidArgumentError(
        "auto is no learner to measure; name the learners, the chosen one is measured anyway");
  }
  PLEAT_RETURN_IF_ERROR(CheckTestSequence(sequence, test_sequence, options));
  PLEAT_ASSIGN_OR_RETURN(FrameSplit split, SplitFrames(options.protocol, sequence.num_frames()));
  LapTimer timer(options.clock_seconds);
  PLEAT_ASSIGN_OR_RETURN(const TrainingFrames frames,
                         TrainingSide(sequence, split.train, options.more_training_clips));
  PLEAT_ASSIGN_OR_RETURN(RiggedFrames rigged, RigFrames(frames, options.train, options.resources,
                                                        progress.Stage("rig", 0, .4)));
  std::map<std::string, double> seconds = {{"rig", timer.Lap()}};
  PLEAT_ASSIGN_OR_RETURN(PoseTrack train_track,
                         FitTrainingFrames(options.train, options.resources, &rigged, nullptr,
                                           progress.Stage("fit", .4, .7)));
  TestSide test{test_sequence ? *test_sequence : sequence, {}, std::move(split.test)};
  PLEAT_ASSIGN_OR_RETURN(test.track,
                         FitFrames(test.sequence, {0}, rigged.rig, options.train, options.resources,
                                   nullptr, progress.Stage("fit", .7, 1)));
  if (test_sequence) {
    for (int t = 0; t < test.sequence.num_frames(); ++t) test.frames.push_back(t);
  }
  seconds["fit"] = timer.Lap();
  return EvaluationSetup{std::move(rigged), std::move(train_track), std::move(test),
                         BoundsDiagonal(sequence.FrameAsDouble(0)), std::move(seconds)};
}

absl::StatusOr<EvaluateReport> EvaluateLearning(const EvaluationSetup& setup,
                                                const TrainOptions& train,
                                                const EvaluateOptions& options,
                                                const Progress& progress) {
  EvaluateReport report;
  report.protocol = EvaluationProtocolName(options.protocol);
  report.options = train;
  report.diagonal_m = setup.diagonal_m;
  report.num_train_frames = setup.rigged.frames.sequence.num_frames();
  report.num_test_frames = static_cast<int>(setup.test.frames.size());
  report.test_frames = setup.test.frames;
  report.seconds = setup.seconds;
  LapTimer timer(options.clock_seconds);
  PLEAT_ASSIGN_OR_RETURN(const LearningData data,
                         ComputeLearningData(setup.rigged, setup.train_track, train,
                                             options.resources, progress.Stage("detail", 0, .1)));
  report.num_control_vertices = static_cast<int>(data.control_vertices.size());
  PLEAT_ASSIGN_OR_RETURN(const LearnerChoice learner,
                         ChooseLearner(data, setup.rigged.rig, train, report.diagonal_m,
                                       &report.validation, progress.Stage("validate", .1, .25)));
  report.learner = ChoiceName(learner);
  PLEAT_ASSIGN_OR_RETURN(const ModelsByLearner models,
                         LearnModels(setup.rigged, data, LearnersToMeasure(options, learner), train,
                                     report.diagonal_m, progress.Stage("learn", .25, .55)));
  std::map<std::string, DetailPredictor> baselines;
  if (options.measure_baselines) {
    PLEAT_ASSIGN_OR_RETURN(baselines, TrainBaselines(data));
  }
  report.seconds["learn"] = timer.Lap();
  PLEAT_RETURN_IF_ERROR(
      MeasureAll(models, baselines, setup.test, progress.Stage("predict", .55, 1), &report));
  report.hybrid = report.learners[report.learner];
  report.seconds["predict"] = timer.Lap();
  return report;
}

absl::StatusOr<EvaluateReport> EvaluateCharacter(const MeshSequence& sequence,
                                                 const std::optional<MeshSequence>& test_sequence,
                                                 const EvaluateOptions& options,
                                                 const Progress& progress) {
  const Progress forward = progress.ForwardOnly();
  PLEAT_ASSIGN_OR_RETURN(
      const EvaluationSetup setup,
      PrepareEvaluation(sequence, test_sequence, options, forward.Stage("", 0, .35)));
  return EvaluateLearning(setup, options.train, options, forward.Stage("", .35, 1));
}

}  // namespace pleat
