// batch LIST -o FOLDER: trains or compresses many takes with one command, and goes on where it was.
#include <chrono>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "cli/batch/batch_list.h"
#include "cli/batch/batch_report.h"
#include "cli/batch/batch_run.h"
#include "cli/batch/batch_work.h"
#include "cli/exit_code.h"
#include "cli/interrupt.h"
#include "cli/service.h"
#include "cli/show/json_text.h"
#include "cli/show/progress_display.h"
#include "cli/verbs/compress_flags.h"
#include "cli/verbs/train_flags.h"
#include "cli/verbs/verbs.h"
#include "pleat/base/file.h"
#include "pleat/base/status.h"
#include "pleat/base/utf8.h"

namespace pleat {
namespace {

constexpr auto kInterruptInterval = std::chrono::milliseconds(50);
constexpr char kReportName[] = "batch.jsonl";

struct BatchVerbOptions {
  std::string list, report;
  BatchRules rules;
  BatchJob job;
  TrainFlags train;
  CompressFlags compress;
  double patience_minutes = 10, ttl_hours = 0;
};

absl::Status ResolveJob(BatchVerbOptions* options) {
  if (options->compress.any_goal()) {
    if (!options->train.values.empty() || !options->train.preset.empty()) {
      return UsageError("a batch trains or compresses: give options of one of the two");
    }
    PLEAT_ASSIGN_OR_RETURN(options->job.options, ResolveCompressFlags(options->compress));
  } else {
    PLEAT_ASSIGN_OR_RETURN(options->job.options, ResolveTrainFlags(options->train));
  }
  options->job.ttl = TtlOf(options->ttl_hours);
  options->rules.patience_seconds = 60 * options->patience_minutes;
  return absl::OkStatus();
}

// Makes the folder of the results and says where the report is.
absl::StatusOr<std::string> PrepareOutput(const BatchVerbOptions& options) {
  const std::string& folder = options.job.output_dir;
  if (folder.empty() && options.report.empty()) {
    return UsageError("say where results go (-o FOLDER), or at least the report (--report FILE)");
  }
  if (!folder.empty()) {
    std::error_code error;
    std::filesystem::create_directories(folder, error);
    if (error) return ErrnoStatus(error.value(), absl::StrCat("cannot make ", folder));
  }
  return options.report.empty() ? (std::filesystem::path(folder) / kReportName).string()
                                : options.report;
}

bool WaitUnlessInterrupted(double seconds) {
  const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(seconds);
  while (!Interrupted() && std::chrono::steady_clock::now() < end) {
    std::this_thread::sleep_for(kInterruptInterval);
  }
  return !Interrupted();
}

void TellRow(const Session& session, const BatchRow& row, size_t num_done, size_t num_takes) {
  if (!session.talkative()) return;
  *session.err << absl::StrFormat("[%d/%d] %s: ", num_done, num_takes, EscapeControls(row.name));
  if (!row.status.ok()) {
    *session.err << EscapeControls(std::string(row.status.message()));
  } else {
    *session.err << "done";
    if (row.mean_error_mm >= 0) *session.err << absl::StrFormat(", %.2f mm", row.mean_error_mm);
  }
  *session.err << ", " << FormatDuration(row.seconds) << std::endl;
}

absl::Status SayEnd(const Session& session, const BatchSummary& summary, size_t num_takes,
                    const std::string& report) {
  size_t num_failed = 0;
  for (const BatchRow& row : summary.rows) num_failed += row.status.ok() ? 0 : 1;
  const size_t num_done = summary.rows.size() - num_failed;
  if (session.json) {
    *session.out << JsonText({{"schema", "pleat.batch_summary/1"},
                              {"num_takes", num_takes},
                              {"num_done", num_done},
                              {"num_done_before", summary.num_skipped},
                              {"num_failed", num_failed},
                              {"report", report}});
  } else {
    *session.out << BatchErrorTable(summary.rows)
                 << absl::StrFormat("%d takes: %d done, %d were done before, %d failed; %s\n",
                                    num_takes, num_done, summary.num_skipped, num_failed, report);
  }
  if (num_failed == 0) return absl::OkStatus();
  return absl::FailedPreconditionError(
      absl::StrCat(num_failed, " of ", num_takes, " takes failed: ", report,
                   " says why; the same command tries them again"));
}

absl::Status RunBatchVerb(BatchVerbOptions options, const Session& session) {
  PLEAT_RETURN_IF_ERROR(ResolveJob(&options));
  PLEAT_ASSIGN_OR_RETURN(const std::string text, ReadFile(options.list));
  PLEAT_ASSIGN_OR_RETURN(
      const std::vector<BatchTake> takes,
      WithContext(
          options.list,
          ParseBatchList(text, std::filesystem::path(options.list).parent_path().string())));
  PLEAT_ASSIGN_OR_RETURN(const std::string report_path, PrepareOutput(options));
  PLEAT_ASSIGN_OR_RETURN(const std::unique_ptr<BatchReport> report, BatchReport::Open(report_path));
  PLEAT_ASSIGN_OR_RETURN(const std::unique_ptr<CharacterService> service, OpenService(session));
  const BatchSteps steps{
      .fingerprint = [&](const BatchTake& take) { return FingerprintOf(take, options.job); },
      .work =
          [&](const BatchTake& take, int attempt, BatchRow* row) {
            WorkOnTake(service.get(), session, options.job, take, attempt, row);
          },
      .wait = WaitUnlessInterrupted,
      .interrupted = Interrupted,
      .clock_seconds = MonotonicSeconds,
      .tell = [&](const BatchRow& row, size_t num_done,
                  size_t num_takes) { TellRow(session, row, num_done, num_takes); }};
  PLEAT_ASSIGN_OR_RETURN(const BatchSummary summary,
                         RunBatch(takes, report.get(), options.rules, steps));
  return SayEnd(session, summary, takes.size(), report_path);
}

}  // namespace

void AddBatchVerb(CLI::App& app, Session& session) {
  auto options = std::make_shared<BatchVerbOptions>();
  CLI::App* verb =
      AddVerb(app, session, "batch", "train or compress the takes of a list, resumably",
              [options, &session] { return RunBatchVerb(*options, session); });
  verb->add_option("LIST", options->list,
                   "a path on each line, or {\"input\": [PATH, ...], \"name\": NAME}")
      ->required()
      ->check(CLI::ExistingFile);
  verb->add_option("-o,--output", options->job.output_dir,
                   "folder of the results: NAME.pleat or NAME.plt [they stay on the service]");
  verb->add_option("--report", options->report,
                   absl::StrCat("a line of JSON for each take (pleat.batch/1); a later run goes on "
                                "with it [FOLDER/",
                                kReportName, "]"));
  verb->add_option("--in-flight", options->rules.in_flight, "takes at the same time")
      ->check(CLI::Range(1, 256))
      ->capture_default_str();
  verb->add_option("--patience-minutes", options->patience_minutes,
                   "how long a take waits for a server that cannot be reached")
      ->check(CLI::Range(0., 1e5))
      ->capture_default_str();
  verb->add_option("--fps", options->job.fps, "frames per second, where the inputs do not say");
  AddObjectFlag(verb, session);
  AddCompressFlags(verb, &options->compress);
  AddTrainFlags(verb, &options->train);
  AddTtlFlag(verb, "the takes and their results", &options->ttl_hours);
  AddServerFlags(verb, session);
}

}  // namespace pleat
