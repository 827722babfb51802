#include "pleat/local/retention.h"

#include <algorithm>
#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <utility>

#include "absl/strings/str_cat.h"
#include "job_rows.h"
#include "pleat/base/status.h"
#include "stored_infos.h"

namespace pleat {
namespace {

// Jobs that are in memory together while they are removed.
constexpr int64_t kJobsTogether = 1000;

using SequenceOfProject = std::pair<std::string, std::string>;  // project and id

std::set<SequenceOfProject> SequencesInUse(const UnfinishedJobs& unfinished) {
  std::set<SequenceOfProject> in_use;
  for (const StoredJob& job : unfinished.jobs) {
    for (const std::string& id : job.info.sequence_ids) in_use.emplace(job.info.project, id);
  }
  return in_use;
}

// One run over everything that may have to go.
class RetentionPass {
 public:
  RetentionPass(const RetentionTarget& target, const RetentionRules& rules)
      : target_(target), rules_(rules), now_(target.files->clock()()) {}

  size_t Run() {
    RemoveJobs();
    RemoveExpired<ModelInfo>({});
    RemoveExpired<CompressedSequenceInfo>({});
    if (const auto unfinished = ReadUnfinishedJobs(target_.files); !unfinished.ok()) {
      Report("the sequences that jobs work on", unfinished.status());
    } else {
      RemoveExpired<SequenceInfo>(SequencesInUse(*unfinished));
    }
    RemoveUploads();
    return num_removed_;
  }

 private:
  // By age first, then those that are too many still, of each project the ones that ended first.
  void RemoveJobs() {
    if (const auto noted = ReadUnfinishedJobs(target_.files); !noted.ok()) {
      return Report("jobs", noted.status());
    }
    const auto counts = target_.files->store().catalog().CountJobs();
    if (!counts.ok()) return Report("jobs", counts.status());
    std::map<std::string, int64_t> num_ended;  // by project
    for (const Catalog::JobCount& count : *counts) {
      for (const JobState state : {JobState::kSucceeded, JobState::kFailed, JobState::kCancelled}) {
        if (count.state == JobStateName(state)) num_ended[count.project] += count.num;
      }
    }
    for (auto& [project, num] : num_ended) {
      if (rules_.max_job_age < absl::InfiniteDuration()) {
        num -= RemoveEndedJobs(
            project, {.from = 1, .before = absl::ToUnixMillis(now_ - rules_.max_job_age)}, num,
            absl::StrCat("it ended more than ", absl::FormatDuration(rules_.max_job_age), " ago"));
      }
      if (rules_.max_ended_jobs > 0) {
        RemoveEndedJobs(
            project, {}, num - rules_.max_ended_jobs,
            absl::StrCat("only the newest ", rules_.max_ended_jobs, " that have ended stay"));
      }
    }
  }

  struct TimeRange {
    int64_t from = 0, before = INT64_MAX;  // milliseconds since 1970; 0: not known
  };
  // Removes at most `max_jobs` of those that ended in the range, and returns how many are gone.
  int64_t RemoveEndedJobs(const std::string& project, const TimeRange& range, int64_t max_jobs,
                          const std::string& why) {
    int64_t num_gone = 0;
    while (num_gone < max_jobs) {
      const int num = static_cast<int>(std::min(max_jobs - num_gone, kJobsTogether));
      const auto entries =
          target_.files->store().catalog().ListEndedJobs(project, range.from, range.before, num);
      if (!entries.ok()) Report("jobs", entries.status());
      if (!entries.ok() || entries->empty()) break;
      for (const CatalogEntry& entry : *entries) {
        if (!RemoveJob(entry, why)) return num_gone;  // the next run goes on
        ++num_gone;
      }
    }
    return num_gone;
  }

  bool RemoveJob(const CatalogEntry& entry, const std::string& why) {
    const absl::StatusOr<JobInfo> job = InfoOf<JobInfo>(entry);
    const std::string what = absl::StrCat("the job '", entry.id, "'",
                                          job.ok() ? absl::StrCat(" ('", job->name, "')") : "");
    const absl::Status status =
        target_.files->store().catalog().Delete({EntryKind::kJob, entry.project}, entry.id);
    if (status.ok()) Removed(what, why);
    if (status.ok() || absl::IsNotFound(status)) return true;  // or somebody else deleted it
    Report(what, status);
    return false;
  }

  template <typename Info>
  void RemoveExpired(const std::set<SequenceOfProject>& in_use) {
    constexpr EntryKind kKind = StoredKind<Info>::kind;
    const int64_t now_ms = absl::ToUnixMillis(now_);
    const auto entries = target_.files->store().catalog().ListExpired(kKind, now_ms);
    if (!entries.ok()) {
      return Report(absl::StrCat("the ", EntryKindName(kKind), "s that expire"), entries.status());
    }
    for (const CatalogEntry& entry : *entries) {
      if (in_use.contains({entry.project, entry.id})) continue;
      const absl::StatusOr<Info> info = InfoOf<Info>(entry);
      const std::string what = absl::StrCat("the ", EntryKindName(kKind), " '", entry.id, "'",
                                            info.ok() ? absl::StrCat(" ('", info->name, "')") : "");
      // Looks at pin and life once more, in the same commit.
      const absl::Status status =
          target_.files->store().DeleteExpired({kKind, entry.project}, entry.id, now_ms);
      if (status.ok()) {
        if (kKind == EntryKind::kModel && target_.on_model_removed) {
          target_.on_model_removed(entry.id);
        }
        Removed(what, "its time to live is over");
      } else if (!absl::IsNotFound(status)) {
        Report(what, status);
      }
    }
  }

  void RemoveUploads() {
    const absl::Time oldest = now_ - rules_.max_upload_age;
    Store& store = target_.files->store();
    for (const std::string& project : store.UploadProjects()) {
      const absl::StatusOr<UploadArea*> uploads = store.uploads(project);
      if (!uploads.ok()) continue;
      for (const std::string& id : (*uploads)->RemoveUntouchedSince(oldest)) {
        Removed(absl::StrCat("what had arrived of the upload '", id, "'"),
                absl::StrCat("nobody went on with it for ",
                             absl::FormatDuration(rules_.max_upload_age)));
      }
    }
  }

  void Removed(const std::string& what, const std::string& why) {
    ++num_removed_;
    if (target_.on_removed) {
      target_.on_removed(absl::StrCat("retention removed ", what, ": ", why));
    }
  }
  void Report(const std::string& what, const absl::Status& status) {
    target_.files->store().Report(
        absl::StrCat("retention cannot remove ", what, ": ", std::string(status.message())));
  }

  const RetentionTarget& target_;
  const RetentionRules& rules_;
  const absl::Time now_;
  size_t num_removed_ = 0;
};

}  // namespace

size_t RunRetention(const RetentionTarget& target, const RetentionRules& rules) {
  return RetentionPass(target, rules).Run();
}

}  // namespace pleat
