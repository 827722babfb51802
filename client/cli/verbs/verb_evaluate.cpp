// evaluate INPUT --protocol P: measures the held-out errors of the whole pipeline, always in this
// process.
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "cli/exit_code.h"
#include "cli/io/input.h"
#include "cli/io/output_path.h"
#include "cli/show/error_text.h"
#include "cli/show/experiment_files.h"
#include "cli/show/json_text.h"
#include "cli/show/progress_display.h"
#include "cli/show/report_json.h"
#include "cli/show/text_table.h"
#include "cli/verbs/train_flags.h"
#include "cli/verbs/verbs.h"
#include "pleat/base/file.h"
#include "pleat/base/status.h"
#include "pleat/character/evaluate.h"
#include "pleat/character/experiment.h"

namespace pleat {
namespace {

struct EvaluateVerbOptions {
  std::vector<std::string> inputs;
  std::string test_input, protocol, report, fps, experiment, out;
  std::vector<std::string> measured;  // the names of the learners to measure
  TrainFlags flags;
  EvaluateOptions evaluate;
};

void PrintText(const EvaluateReport& report, std::ostream& out) {
  std::vector<std::vector<std::string>> rows;
  const auto add = [&](const std::string& name, const ErrorSummary& error) {
    rows.push_back(MotionTableRow(name, error));
  };
  add("skinned only", report.skinned);
  add("hybrid (" + report.learner + ")", report.hybrid);
  for (const auto& [name, error] : report.learners) add("learner " + name, error);
  for (const auto& [name, error] : report.baselines) add("baseline " + name, error);
  out << absl::StrFormat("protocol %s: %d training frames, %d test frames, diagonal %.3f m\n",
                         report.protocol, report.num_train_frames, report.num_test_frames,
                         report.diagonal_m)
      << FormatTable(MotionTableHeader("test frames"), rows);
  if (report.skinned.num_jitter_frames > 0) {
    out << absl::StrFormat("jitter of the input itself: %.2f mm\n", report.skinned.truth_jitter_mm);
  }
  out << ValidationText(report.validation);
}

// The clips of an evaluation.
struct Clips {
  MeshSequence sequence;
  std::optional<MeshSequence> test;
};

// Checks the combination of flags, and fills in the protocol and the training options.
absl::Status ResolveFlags(EvaluateVerbOptions* options) {
  const bool is_experiment = !options->experiment.empty();
  if (options->protocol.empty()) options->protocol = is_experiment ? "reconstruct" : "blocks10";
  if (options->flags.preset.empty()) options->flags.preset = is_experiment ? "paper" : "default";
  absl::StatusOr<EvaluationProtocol> protocol = ParseEvaluationProtocol(options->protocol);
  if (!protocol.ok()) return UsageError(std::string(protocol.status().message()));
  options->evaluate.protocol = *protocol;
  const bool cross = *protocol == EvaluationProtocol::kCross;
  if (cross == options->test_input.empty()) {
    return UsageError(cross ? "protocol cross needs --test INPUT2"
                            : "--test goes with --protocol cross only");
  }
  if (!cross && options->inputs.size() > 1) {
    return UsageError("several training clips go with --protocol cross only");
  }
  if (is_experiment == options->out.empty()) {
    return UsageError("--experiment and --out FOLDER go together");
  }
  PLEAT_ASSIGN_OR_RETURN(options->evaluate.train, ResolveTrainFlags(options->flags));
  options->evaluate.learners.clear();
  for (const std::string& name : options->measured) {
    PLEAT_ASSIGN_OR_RETURN(const LearnerChoice learner,
                           ParseChoice<LearnerChoice>("measure", name));
    options->evaluate.learners.push_back(learner);
  }
  options->evaluate.clock_seconds = MonotonicSeconds;
  return absl::OkStatus();
}

absl::StatusOr<Clips> ReadClips(const Session& session, EvaluateVerbOptions* options) {
  PLEAT_ASSIGN_OR_RETURN(MeshSequence sequence,
                         ReadInput(session, options->inputs.front(), options->fps));
  for (size_t i = 1; i < options->inputs.size(); ++i) {
    PLEAT_ASSIGN_OR_RETURN(MeshSequence clip, ReadInput(session, options->inputs[i], options->fps));
    options->evaluate.more_training_clips.push_back(std::move(clip));
  }
  if (options->inputs.size() == 1) {
    PLEAT_RETURN_IF_ERROR(CheckIsClip(sequence, options->inputs.front()));
  }
  Clips clips{std::move(sequence), std::nullopt};
  if (!options->test_input.empty()) {
    PLEAT_ASSIGN_OR_RETURN(clips.test, ReadInput(session, options->test_input, options->fps));
  }
  return clips;
}

// Writes JSON, Markdown and plots into the folder, and the table or the JSON to standard output.
absl::Status RunExperimentVerb(EvaluateVerbOptions options, const Session& session) {
  absl::StatusOr<Experiment> experiment = ParseExperiment(options.experiment);
  if (!experiment.ok()) return UsageError(std::string(experiment.status().message()));
  PLEAT_RETURN_IF_ERROR(CheckOutputFolder(session, "--out", options.out));
  PLEAT_ASSIGN_OR_RETURN(const Clips clips, ReadClips(session, &options));
  ProgressDisplay display(*session.err, ChooseProgressStyle(session), MonotonicSeconds);
  PLEAT_ASSIGN_OR_RETURN(const ExperimentReport report,
                         RunExperiment(clips.sequence, clips.test, *experiment, options.evaluate,
                                       InterruptibleProgress(&display)));
  display.Finish();
  const ExperimentSubject subject{
      clips.test ? absl::StrCat(clips.sequence.name(), " -> ", clips.test->name())
                 : clips.sequence.name(),
      options.flags.preset};
  const nlohmann::ordered_json json = ExperimentJson(report, subject);
  PLEAT_ASSIGN_OR_RETURN(auto files, ExperimentPlots(report, subject));
  files[options.experiment + ".json"] = JsonText(json);
  files[options.experiment + ".md"] = ExperimentMarkdown(report, subject);
  for (const auto& [name, bytes] : files) {
    PLEAT_RETURN_IF_ERROR(WriteFile(absl::StrCat(options.out, "/", name), bytes));
  }
  if (session.json) {
    *session.out << JsonText(json);
  } else {
    *session.out << FormatTable(ExperimentTableHeader(), ExperimentTableRows(report));
  }
  return absl::OkStatus();
}

absl::Status RunEvaluate(EvaluateVerbOptions options, const Session& session) {
  PLEAT_RETURN_IF_ERROR(ResolveFlags(&options));
  if (!options.experiment.empty()) return RunExperimentVerb(std::move(options), session);
  PLEAT_RETURN_IF_ERROR(CheckOutputFiles(session, {{"--report", options.report, {".json"}}}));
  const double start_seconds = MonotonicSeconds();
  PLEAT_ASSIGN_OR_RETURN(const Clips clips, ReadClips(session, &options));
  const double read_seconds = MonotonicSeconds() - start_seconds;
  ProgressDisplay display(*session.err, ChooseProgressStyle(session), MonotonicSeconds);
  PLEAT_ASSIGN_OR_RETURN(EvaluateReport report,
                         EvaluateCharacter(clips.sequence, clips.test, options.evaluate,
                                           InterruptibleProgress(&display)));
  display.Finish();
  report.seconds["read"] = read_seconds;

  const nlohmann::ordered_json json = EvaluateReportJson(report);
  if (!options.report.empty()) {
    PLEAT_RETURN_IF_ERROR(WriteFile(options.report, JsonText(json)));
  }
  if (session.json) {
    *session.out << JsonText(json);
  } else {
    PrintText(report, *session.out);
  }
  return absl::OkStatus();
}

}  // namespace

void AddEvaluateVerb(CLI::App& app, Session& session) {
  auto options = std::make_shared<EvaluateVerbOptions>();
  CLI::App* verb =
      AddVerb(app, session, "evaluate", "train on some frames and measure the error on others",
              [options, &session] { return RunEvaluate(*options, session); });
  verb->add_option(
          "INPUT", options->inputs,
          "any animation that pleat reads; several are the training clips of protocol cross")
      ->required();
  verb->add_option("--protocol", options->protocol,
                   "reconstruct, every5th, blocks10, last30 or cross [blocks10; of an experiment "
                   "reconstruct, as in the paper]");
  verb->add_option("--test", options->test_input, "the second clip of protocol cross");
  verb->add_option("--experiment", options->experiment,
                   "compare as the paper does: full-vs-fine, representations, resolutions or "
                   "skinned-vs-hybrid; with --preset paper unless another is given");
  verb->add_option("--out", options->out,
                   "folder for the experiment's table (JSON, Markdown) and plots (PNG)");
  verb->add_option("--report", options->report, "JSON report (pleat.evaluate/1)");
  for (const LearnerChoice learner : options->evaluate.learners) {
    options->measured.push_back(ChoiceName(learner));
  }
  verb->add_option("--measure", options->measured, "learners to measure beside the chosen one")
      ->check(CLI::IsMember(LearnerNames()))
      ->capture_default_str();
  verb->add_option("--fps", options->fps, "frames per second, where the inputs do not say");
  AddObjectFlag(verb, session);
  verb->add_option("--threads", options->evaluate.resources.num_threads, "0 = one per core")
      ->check(CLI::Range(0, 1024))
      ->capture_default_str();
  AddTrainFlags(verb, &options->flags);
  AddForceFlag(verb, session);
  AddInProcessFlag(verb, session);
}

}  // namespace pleat
