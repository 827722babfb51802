// evaluate INPUT --protocol P: held-out errors of the whole pipeline, always in this process.
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <utility>
#include <vector>

#include "absl/strings/str_format.h"
#include "cli/error_text.h"
#include "cli/exit_code.h"
#include "cli/input.h"
#include "cli/progress_display.h"
#include "cli/report_json.h"
#include "cli/text_table.h"
#include "cli/train_flags.h"
#include "cli/verbs.h"
#include "pleat/base/file.h"
#include "pleat/base/status.h"
#include "pleat/character/evaluate.h"

namespace pleat {
namespace {

struct EvaluateVerbOptions {
  std::vector<std::string> inputs;
  std::string test_input, protocol = "blocks10", report, fps;
  TrainFlags flags;
  EvaluateOptions evaluate;
};

void PrintText(const EvaluateReport& report, std::ostream& out) {
  std::vector<std::vector<std::string>> rows;
  const auto add = [&](const std::string& name, const ErrorSummary& error) {
    rows.push_back(ErrorTableRow(name, error, report.diagonal_m));
  };
  add("skinned only", report.skinned);
  add("hybrid (" + report.learner + ")", report.hybrid);
  for (const auto& [name, error] : report.learners) add("learner " + name, error);
  for (const auto& [name, error] : report.baselines) add("baseline " + name, error);
  out << absl::StrFormat("protocol %s: %d training frames, %d test frames, diagonal %.3f m\n",
                         report.protocol, report.num_train_frames, report.num_test_frames,
                         report.diagonal_m)
      << FormatTable(ErrorTableHeader("test frames"), rows);
}

absl::Status RunEvaluate(EvaluateVerbOptions options, const Session& session) {
  absl::StatusOr<EvaluationProtocol> protocol = ParseEvaluationProtocol(options.protocol);
  if (!protocol.ok()) return UsageError(std::string(protocol.status().message()));
  options.evaluate.protocol = *protocol;
  const bool cross = *protocol == EvaluationProtocol::kCross;
  if (cross == options.test_input.empty()) {
    return UsageError(cross ? "protocol cross needs --test INPUT2"
                            : "--test goes with --protocol cross only");
  }
  if (!cross && options.inputs.size() > 1) {
    return UsageError("several training clips go with --protocol cross only");
  }
  PLEAT_ASSIGN_OR_RETURN(options.evaluate.train, ResolveTrainFlags(options.flags));
  options.evaluate.clock_seconds = MonotonicSeconds;

  const double start_seconds = MonotonicSeconds();
  PLEAT_ASSIGN_OR_RETURN(const MeshSequence sequence,
                         ReadInput(session, options.inputs.front(), options.fps));
  for (size_t i = 1; i < options.inputs.size(); ++i) {
    PLEAT_ASSIGN_OR_RETURN(MeshSequence clip, ReadInput(session, options.inputs[i], options.fps));
    options.evaluate.more_training_clips.push_back(std::move(clip));
  }
  std::optional<MeshSequence> test_sequence;
  if (cross) {
    PLEAT_ASSIGN_OR_RETURN(test_sequence, ReadInput(session, options.test_input, options.fps));
  }
  const double read_seconds = MonotonicSeconds() - start_seconds;
  ProgressDisplay display(*session.err, ChooseProgressStyle(session), MonotonicSeconds);
  PLEAT_ASSIGN_OR_RETURN(EvaluateReport report,
                         EvaluateCharacter(sequence, test_sequence, options.evaluate,
                                           InterruptibleProgress(&display)));
  display.Finish();
  report.seconds["read"] = read_seconds;

  const nlohmann::ordered_json json = EvaluateReportJson(report);
  if (!options.report.empty()) {
    PLEAT_RETURN_IF_ERROR(WriteFile(options.report, json.dump(2) + "\n"));
  }
  if (session.json) {
    *session.out << json.dump(2) << "\n";
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
  verb->add_option("INPUT", options->inputs,
                   "folder, glob, .pc2 or .pseq; several are the training clips of protocol cross")
      ->required();
  verb->add_option("--protocol", options->protocol,
                   "reconstruct, every5th, blocks10, last30 or cross")
      ->capture_default_str();
  verb->add_option("--test", options->test_input, "the second clip of protocol cross");
  verb->add_option("--report", options->report, "JSON report (pleat.evaluate/1)");
  verb->add_option("--measure", options->evaluate.learners,
                   "learners to measure beside the chosen one")
      ->check(CLI::IsMember(LearnerNames()))
      ->capture_default_str();
  verb->add_option("--fps", options->fps, "frames per second, where the inputs do not say");
  verb->add_option("--threads", options->evaluate.resources.num_threads, "0 = one per core")
      ->check(CLI::Range(0, 1024))
      ->capture_default_str();
  AddTrainFlags(verb, &options->flags);
  AddInProcessFlag(verb, session);
}

}  // namespace pleat
