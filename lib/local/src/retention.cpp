#include "pleat/local/retention.h"

#include <algorithm>
#include <map>
#include <utility>

#include "absl/strings/str_cat.h"
#include "pleat/base/status.h"
#include "stored_infos.h"

namespace pleat {
namespace {

// One run over everything that may have to go.
class RetentionPass {
 public:
  RetentionPass(const RetentionTarget& target, const RetentionRules& rules)
      : target_(target), rules_(rules), now_(target.files->clock()()) {}

  size_t Run() {
    RemoveJobs();
    RemoveExpired<ModelInfo>({});
    RemoveExpired<CompressedSequenceInfo>({});
    if (const auto in_use = target_.jobs.sequences_in_use(); in_use.ok()) {
      RemoveExpired<SequenceInfo>(*in_use);
    } else {
      Report("the sequences that jobs work on", in_use.status());
    }
    RemoveUploads();
    return num_removed_;
  }

 private:
  void RemoveJobs() {
    absl::StatusOr<std::vector<EndedJob>> jobs = target_.jobs.ended();
    if (!jobs.ok()) return Report("the jobs that have ended", jobs.status());
    for (const JobToRemove& it : ChooseJobsToRemove(*std::move(jobs), rules_, now_)) {
      const std::string what = absl::StrCat("the job '", it.job.id, "' ('", it.job.name, "')");
      const absl::Status status = target_.jobs.remove(it.job);
      if (status.ok()) {
        Removed(what, it.why);
      } else if (!absl::IsNotFound(status)) {  // somebody else deleted it
        Report(what, status);
      }
    }
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

// All rows of jobs that can be read, of all projects.
absl::StatusOr<std::vector<JobInfo>> ReadJobs(StoredFiles* files) {
  PLEAT_ASSIGN_OR_RETURN(const std::vector<CatalogEntry> entries,
                         files->store().catalog().List(EntryKind::kJob));
  std::vector<JobInfo> jobs;
  for (const CatalogEntry& entry : entries) {
    absl::StatusOr<JobInfo> job = InfoOf<JobInfo>(entry);
    if (job.ok()) {
      jobs.push_back(*std::move(job));
    } else {
      files->ReportBadRow(EntryKind::kJob, entry.id, job.status());
    }
  }
  return jobs;
}

}  // namespace

std::vector<JobToRemove> ChooseJobsToRemove(std::vector<EndedJob> jobs, const RetentionRules& rules,
                                            absl::Time now) {
  std::ranges::stable_sort(
      jobs, {}, [](const EndedJob& job) { return job.ended.value_or(absl::InfinitePast()); });
  std::map<std::string, int64_t> num_too_many;  // by project
  for (const EndedJob& job : jobs) ++num_too_many[job.project];
  for (auto& [project, num] : num_too_many) {
    num = rules.max_ended_jobs == 0 ? 0 : num - rules.max_ended_jobs;
  }
  std::vector<JobToRemove> chosen;
  for (EndedJob& job : jobs) {
    const bool is_one_too_many = num_too_many[job.project]-- > 0;  // the oldest come first
    const bool is_old = job.ended && now - *job.ended > rules.max_job_age;
    if (is_old) {
      chosen.push_back(
          {std::move(job),
           absl::StrCat("it ended more than ", absl::FormatDuration(rules.max_job_age), " ago")});
    } else if (is_one_too_many) {
      chosen.push_back({std::move(job), absl::StrCat("only the newest ", rules.max_ended_jobs,
                                                     " that have ended stay")});
    }
  }
  return chosen;
}

void AddSequencesInUse(const JobInfo& job, std::set<SequenceOfProject>* in_use) {
  if (IsFinal(job.state)) return;
  for (const std::string& id : job.sequence_ids) in_use->emplace(job.project, id);
}

JobsOfRetention JobsInRows(StoredFiles* files) {
  return {.ended = [files]() -> absl::StatusOr<std::vector<EndedJob>> {
            PLEAT_ASSIGN_OR_RETURN(const std::vector<JobInfo> jobs, ReadJobs(files));
            std::vector<EndedJob> ended;
            for (const JobInfo& job : jobs) {
              if (IsFinal(job.state)) ended.push_back({job.id, job.name, job.ended, job.project});
            }
            return ended;
          },
          .remove =
              [files](const EndedJob& job) {
                return files->store().catalog().Delete({EntryKind::kJob, job.project}, job.id);
              },
          .sequences_in_use = [files]() -> absl::StatusOr<std::set<SequenceOfProject>> {
            PLEAT_ASSIGN_OR_RETURN(const std::vector<JobInfo> jobs, ReadJobs(files));
            std::set<SequenceOfProject> in_use;
            for (const JobInfo& job : jobs) AddSequencesInUse(job, &in_use);
            return in_use;
          }};
}

size_t RunRetention(const RetentionTarget& target, const RetentionRules& rules) {
  return RetentionPass(target, rules).Run();
}

}  // namespace pleat
