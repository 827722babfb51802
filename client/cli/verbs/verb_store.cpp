// store check | backup | restore | repair | scrub | sweep: data folders, on the machine where they
// are.
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <system_error>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "cli/exit_code.h"
#include "cli/show/json_text.h"
#include "cli/show/progress_display.h"
#include "cli/show/text_table.h"
#include "cli/verbs/verbs.h"
#include "pleat/base/status.h"
#include "pleat/local/describe_file.h"
#include "pleat/local/retention_flags.h"
#include "pleat/local/scrubber.h"
#include "pleat/store/store_backup.h"
#include "pleat/store/store_check.h"
#include "pleat/store/store_repair.h"

namespace pleat {
namespace {

using nlohmann::ordered_json;

struct StoreVerbOptions {
  std::string action, folder, target;
  bool fast = false;
  RetentionFlags retention;
};

ordered_json ProblemsJson(const std::vector<StoreProblem>& problems) {
  ordered_json list = ordered_json::array();
  for (const StoreProblem& problem : problems) {
    list.push_back(
        {{"kind", StoreProblemName(problem.kind)}, {"id", problem.id}, {"text", problem.text}});
  }
  return list;
}

void PrintProblems(const std::vector<StoreProblem>& problems, std::ostream& out) {
  for (const StoreProblem& problem : problems) {
    out << StoreProblemName(problem.kind) << ": " << problem.text << "\n";
  }
}

// What was asked for was done and printed; the exit code says that something is wrong.
absl::Status ProblemStatus(const std::string& folder, size_t num_problems,
                           const std::string& what_to_do) {
  if (num_problems == 0) return absl::OkStatus();
  return absl::FailedPreconditionError(absl::StrCat("'", folder, "' has ", num_problems,
                                                    num_problems == 1 ? " problem" : " problems",
                                                    "; ", what_to_do));
}

void PrintCheckJson(const StoreCheck& check, std::ostream& out) {
  ordered_json json;
  json["store_id"] = check.store_id;
  for (const EntryKind kind : kEntryKinds) {
    json["entries"][EntryKindName(kind)] = check.num_entries[static_cast<size_t>(kind)];
  }
  json["files"] = check.num_files;
  json["bytes"] = check.num_bytes;
  json["problems"] = ProblemsJson(check.problems);
  json["quarantine"] = ordered_json::array();
  for (const QuarantinedFile& file : check.quarantine) {
    json["quarantine"].push_back({{"name", file.name},
                                  {"time", file.time},
                                  {"reason", file.reason},
                                  {"bytes", file.size_bytes}});
  }
  out << JsonText(json);
}

void PrintCheckText(const StoreCheck& check, std::ostream& out) {
  out << "store       " << (check.store_id.empty() ? "without an id" : check.store_id) << "\n";
  for (const EntryKind kind : kEntryKinds) {
    out << absl::StrFormat("%-20s %d\n", absl::StrCat(EntryKindName(kind), "s"),
                           check.num_entries[static_cast<size_t>(kind)]);
  }
  out << absl::StrFormat("%-20s %d, %s\n", "files", check.num_files,
                         FormatBytes(static_cast<double>(check.num_bytes)));
  for (const QuarantinedFile& file : check.quarantine) {
    out << absl::StrFormat("in quarantine: %s (%s%s%s)\n", file.name,
                           FormatBytes(static_cast<double>(file.size_bytes)),
                           file.time.empty() ? "" : ", since " + file.time,
                           file.reason.empty() ? "" : ", " + file.reason);
  }
  PrintProblems(check.problems, out);
}

absl::Status RunCheck(const StoreVerbOptions& options, const Session& session,
                      const Progress& progress) {
  PLEAT_ASSIGN_OR_RETURN(const StoreCheck check,
                         CheckStore(options.folder, !options.fast, progress));
  session.json ? PrintCheckJson(check, *session.out) : PrintCheckText(check, *session.out);
  return ProblemStatus(options.folder, check.problems.size(),
                       "restore a backup or run 'pleat store repair'");
}

absl::Status RunCopy(const StoreVerbOptions& options, const Session& session,
                     const Progress& progress) {
  const auto copy_store = options.action == "backup" ? &BackupStore : &RestoreStore;
  PLEAT_ASSIGN_OR_RETURN(const StoreCopy copy,
                         copy_store(options.folder, options.target, progress));
  if (session.json) {
    *session.out << JsonText({{"copied_files", copy.num_copied},
                              {"copied_bytes", copy.bytes_copied},
                              {"kept_files", copy.num_kept},
                              {"removed_files", copy.num_removed},
                              {"problems", ProblemsJson(copy.problems)}});
  } else {
    *session.out << absl::StrFormat(
        "files copied: %d (%s), already there: %d, removed: %d\n", copy.num_copied,
        FormatBytes(static_cast<double>(copy.bytes_copied)), copy.num_kept, copy.num_removed);
    PrintProblems(copy.problems, *session.out);
  }
  return ProblemStatus(options.folder, copy.problems.size(), "the copy is without these files");
}

absl::Status RunRepair(const StoreVerbOptions& options, const Session& session,
                       const Progress& progress) {
  PLEAT_ASSIGN_OR_RETURN(const StoreRepair repair,
                         RepairStore(options.folder, DescribeStoredFile, progress));
  const std::pair<const char*, const std::vector<std::string>*> lists[] = {
      {"rows made anew", &repair.rows_made},
      {"files returned from the quarantine", &repair.returned},
      {"damaged files moved to the quarantine", &repair.damaged},
      {"files of which nobody can say what they are", &repair.unknown},
      {"entries without a file", &repair.missing}};
  if (session.json) {
    *session.out << JsonText({{"new_catalog", repair.has_new_catalog},
                              {"rows_made", repair.rows_made},
                              {"returned", repair.returned},
                              {"damaged", repair.damaged},
                              {"unknown", repair.unknown},
                              {"missing", repair.missing}});
  } else {
    if (repair.has_new_catalog) {
      *session.out << "the damaged catalog is in quarantine; a new one was made, without jobs\n";
    }
    for (const auto& [title, ids] : lists) {
      *session.out << absl::StrFormat("%-45s %d\n", title, ids->size());
      for (const std::string& id : *ids) *session.out << "  " << id << "\n";
    }
  }
  return ProblemStatus(options.folder, repair.missing.size(),
                       "upload the files of these entries again, restore them or delete them");
}

// Opens a data folder that is there, for itself alone. `problems` receives what is wrong with it.
absl::StatusOr<std::unique_ptr<Store>> OpenStore(const std::string& folder,
                                                 std::vector<std::string>* problems) {
  std::error_code error;
  if (!std::filesystem::exists(CatalogPath(folder), error)) {
    return absl::NotFoundError(
        absl::StrCat("'", folder, "' has no catalogue.db: it is no data folder"));
  }
  return Store::Open(
      {.data_dir = folder, .reserve_bytes = 0, .on_problem = [problems](const std::string& text) {
         problems->push_back(text);
       }});
}

absl::Status PrintSentences(const StoreVerbOptions& options, const Session& session,
                            const std::vector<std::string>& removed,
                            const std::vector<std::string>& problems) {
  if (session.json) {
    *session.out << JsonText({{"removed", removed}, {"problems", problems}});
  } else {
    for (const std::string& sentence : removed) *session.out << sentence << "\n";
    for (const std::string& problem : problems) *session.out << "problem: " << problem << "\n";
  }
  return ProblemStatus(options.folder, problems.size(),
                       "'pleat store check' lists what is wrong now");
}

// What a server's scrubber does in its period, at once.
absl::Status RunScrub(const StoreVerbOptions& options, const Session& session,
                      const Progress& progress) {
  std::vector<std::string> problems;
  PLEAT_ASSIGN_OR_RETURN(const std::unique_ptr<Store> store, OpenStore(options.folder, &problems));
  if (!Scrubber::RunPass(store.get(), 0, [&](double) { return !progress.cancelled(); })) {
    return absl::CancelledError("the scrub was cancelled");
  }
  return PrintSentences(options, session, {}, problems);
}

// What a server's retention does every minute.
absl::Status RunSweep(const StoreVerbOptions& options, const Session& session) {
  std::vector<std::string> removed, problems;
  PLEAT_ASSIGN_OR_RETURN(std::unique_ptr<Store> store, OpenStore(options.folder, &problems));
  StoredFiles files(std::move(store), {});
  RunRetention(
      {.files = &files, .on_removed = [&](const std::string& text) { removed.push_back(text); }},
      RulesOf(options.retention));
  return PrintSentences(options, session, removed, problems);
}

void AddSweepFlags(CLI::App* verb, StoreVerbOptions* options) {
  VisitRetentionFlags(
      options->retention, 0,
      [verb](const char* flag, auto& value, const char* help, double least, double most) {
        verb->add_option(flag, value, absl::StrCat("sweep: ", help))
            ->check(CLI::Range(least, most))
            ->capture_default_str();
      });
}

absl::Status RunStore(const StoreVerbOptions& options, const Session& session) {
  const bool copies = options.action == "backup" || options.action == "restore";
  if (copies == options.target.empty()) {
    return UsageError(copies ? absl::StrCat("store ", options.action, " needs FOLDER and TARGET")
                             : absl::StrCat("store ", options.action, " takes one folder"));
  }
  ProgressDisplay display(*session.err, ChooseProgressStyle(session), MonotonicSeconds);
  const Progress progress = InterruptibleProgress(&display);
  if (copies) return RunCopy(options, session, progress);
  if (options.action == "sweep") return RunSweep(options, session);
  if (options.action == "scrub") return RunScrub(options, session, progress);
  return options.action == "check" ? RunCheck(options, session, progress)
                                   : RunRepair(options, session, progress);
}

}  // namespace

void AddStoreVerb(CLI::App& app, Session& session) {
  auto options = std::make_shared<StoreVerbOptions>();
  CLI::App* verb = AddVerb(app, session, "store",
                           "check, back up, restore, repair, scrub or sweep the data folder of a "
                           "server",
                           [options, &session] { return RunStore(*options, session); });
  verb->add_option("ACTION", options->action, "check, backup, restore, repair, scrub or sweep")
      ->check(CLI::IsMember({"check", "backup", "restore", "repair", "scrub", "sweep"}))
      ->required();
  verb->add_option("FOLDER", options->folder, "the data folder, or the backup (restore)")
      ->required();
  verb->add_option("TARGET", options->target,
                   "where the backup is made or renewed, or the data folder to restore to");
  verb->add_flag("--fast", options->fast, "check: do not read the files, only look for them");
  AddSweepFlags(verb, options.get());
}

}  // namespace pleat
