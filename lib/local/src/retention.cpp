#include "pleat/local/retention.h"

#include <algorithm>
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
      const absl::Status status = target_.jobs.remove(it.job.id);
      if (status.ok()) {
        Removed(what, it.why);
      } else if (!absl::IsNotFound(status)) {  // somebody else deleted it
        Report(what, status);
      }
    }
  }

  template <typename Info>
  void RemoveExpired(const std::set<std::string>& in_use) {
    constexpr EntryKind kKind = StoredKind<Info>::kind;
    const int64_t now_ms = absl::ToUnixMillis(now_);
    const auto entries = target_.files->catalog().ListExpired(kKind, now_ms);
    if (!entries.ok()) {
      return Report(absl::StrCat("the ", EntryKindName(kKind), "s that expire"), entries.status());
    }
    for (const CatalogEntry& entry : *entries) {
      if (in_use.contains(entry.id)) continue;
      const absl::StatusOr<Info> info = InfoOf<Info>(entry);
      const std::string what = absl::StrCat("the ", EntryKindName(kKind), " '", entry.id, "'",
                                            info.ok() ? absl::StrCat(" ('", info->name, "')") : "");
      // Looks at pin and life once more, in the same commit.
      const absl::Status status = target_.files->store().DeleteExpired(kKind, entry.id, now_ms);
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
    for (const std::string& id : target_.files->uploads().RemoveUntouchedSince(oldest)) {
      Removed(
          absl::StrCat("what had arrived of the upload '", id, "'"),
          absl::StrCat("nobody went on with it for ", absl::FormatDuration(rules_.max_upload_age)));
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

// All rows of jobs that can be read.
absl::StatusOr<std::vector<JobInfo>> ReadJobs(StoredFiles* files) {
  return ReadAllPages<JobInfo>(
      [files](const PageRequest& request) { return ListStoredPage<JobInfo>(files, request); });
}

}  // namespace

std::vector<JobToRemove> ChooseJobsToRemove(std::vector<EndedJob> jobs, const RetentionRules& rules,
                                            absl::Time now) {
  std::ranges::stable_sort(
      jobs, {}, [](const EndedJob& job) { return job.ended.value_or(absl::InfinitePast()); });
  const size_t max_jobs =
      rules.max_ended_jobs == 0 ? jobs.size() : static_cast<size_t>(rules.max_ended_jobs);
  const size_t num_too_many = jobs.size() > max_jobs ? jobs.size() - max_jobs : 0;
  std::vector<JobToRemove> chosen;
  for (size_t i = 0; i < jobs.size(); ++i) {
    const bool is_old = jobs[i].ended && now - *jobs[i].ended > rules.max_job_age;
    if (is_old) {
      chosen.push_back(
          {std::move(jobs[i]),
           absl::StrCat("it ended more than ", absl::FormatDuration(rules.max_job_age), " ago")});
    } else if (i < num_too_many) {
      chosen.push_back({std::move(jobs[i]), absl::StrCat("only the newest ", rules.max_ended_jobs,
                                                         " that have ended stay")});
    }
  }
  return chosen;
}

JobsOfRetention JobsInRows(StoredFiles* files) {
  return {
      .ended = [files]() -> absl::StatusOr<std::vector<EndedJob>> {
        PLEAT_ASSIGN_OR_RETURN(const std::vector<JobInfo> jobs, ReadJobs(files));
        std::vector<EndedJob> ended;
        for (const JobInfo& job : jobs) {
          if (IsFinal(job.state)) ended.push_back({job.id, job.name, job.ended});
        }
        return ended;
      },
      .remove =
          [files](const std::string& id) { return files->catalog().Delete(EntryKind::kJob, id); },
      .sequences_in_use = [files]() -> absl::StatusOr<std::set<std::string>> {
        PLEAT_ASSIGN_OR_RETURN(const std::vector<JobInfo> jobs, ReadJobs(files));
        std::set<std::string> ids;
        for (const JobInfo& job : jobs) {
          if (!IsFinal(job.state)) ids.insert(job.sequence_ids.begin(), job.sequence_ids.end());
        }
        return ids;
      }};
}

size_t RunRetention(const RetentionTarget& target, const RetentionRules& rules) {
  return RetentionPass(target, rules).Run();
}

}  // namespace pleat
