// jobs: the training and compression jobs of a service.
#include <memory>
#include <nlohmann/json.hpp>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "cli/exit_code.h"
#include "cli/interrupt.h"
#include "cli/service.h"
#include "cli/show/info_json.h"
#include "cli/show/json_text.h"
#include "cli/show/progress_display.h"
#include "cli/show/text_table.h"
#include "cli/show/time_text.h"
#include "cli/verbs/verbs.h"
#include "pleat/base/status.h"

namespace pleat {
namespace {

struct JobsOptions {
  std::string action = "list", id;
};

void PrintTable(const std::vector<JobInfo>& jobs, std::ostream& out) {
  std::vector<std::vector<std::string>> rows;
  for (const JobInfo& job : jobs) {
    rows.push_back(
        {job.id, JobStateName(job.state), job.stage, absl::StrFormat("%.0f %%", 100 * job.fraction),
         job.eta_seconds ? FormatDuration(*job.eta_seconds) : "", JobKindName(job), job.name,
         job.result_id.substr(0, 12), TimeText(job.created), DurationText(job.started, job.ended)});
  }
  out << FormatTable(
      {"id", "state", "stage", "done", "left", "kind", "name", "result", "created (UTC)", "took"},
      rows);
}

absl::Status RunWatch(JobService& jobs, const std::string& id, const Session& session) {
  ExitOnInterrupt();  // Ctrl-C ends the watching, and the job goes on
  PLEAT_ASSIGN_OR_RETURN(const JobInfo job, WatchJobToEnd(jobs, id, session, false, nullptr));
  *session.out << (session.json ? JsonText(JobJson(job)) : job.result_id + "\n");
  return absl::OkStatus();
}

absl::Status RunJobs(const JobsOptions& options, const Session& session) {
  PLEAT_ASSIGN_OR_RETURN(const std::unique_ptr<CharacterService> service, OpenService(session));
  PLEAT_ASSIGN_OR_RETURN(const std::vector<JobInfo> jobs, service->jobs().List());
  if (options.action == "list") {
    nlohmann::ordered_json json = nlohmann::ordered_json::array();
    for (const JobInfo& job : jobs) json.push_back(JobJson(job));
    if (session.json)
      *session.out << JsonText(json);
    else
      PrintTable(jobs, *session.out);
    return absl::OkStatus();
  }
  if (options.id.empty()) return UsageError(absl::StrCat("'", options.action, "' needs an id"));
  PLEAT_ASSIGN_OR_RETURN(const std::string id, CompleteId(jobs, options.id, "job"));
  if (options.action == "cancel") return service->jobs().Cancel(id);
  if (options.action == "delete") return service->jobs().Delete(id);
  if (options.action == "watch") return RunWatch(service->jobs(), id, session);
  PLEAT_ASSIGN_OR_RETURN(const JobInfo job, service->jobs().Get(id));
  *session.out << JsonText(JobJson(job));
  return absl::OkStatus();
}

}  // namespace

void AddJobsVerb(CLI::App& app, Session& session) {
  auto options = std::make_shared<JobsOptions>();
  CLI::App* verb = AddVerb(app, session, "jobs",
                           "list, show, cancel, watch or delete training and compression jobs",
                           [options, &session] { return RunJobs(*options, session); });
  verb->add_option("ACTION", options->action, "list, show, cancel, watch or delete")
      ->check(CLI::IsMember({"list", "show", "cancel", "watch", "delete"}))
      ->capture_default_str();
  verb->add_option("ID", options->id, "id of a job, or its first digits");
  AddServerFlags(verb, session);
}

}  // namespace pleat
