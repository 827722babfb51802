#include "pleat/local/job_pool.h"

#include <set>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "pleat/base/status.h"
#include "pleat/store/records.h"
#include "stored_infos.h"

namespace pleat {

JobPool::JobPool(StoredFiles* files, RunnerOf runner_of, const JobPoolOptions& options)
    : files_(files),
      runner_of_(std::move(runner_of)),
      manager_(
          JobManagerOptions{.num_workers = options.num_workers,
                            .max_queued_per_client = options.max_queued_per_client,
                            .max_queued_per_project = options.max_queued_per_project,
                            .in_idle_time = options.in_idle_time,
                            .on_stage = options.on_stage,
                            .wall_clock = files->clock()},
          [this](const JobInfo& job, const Progress& progress) {
            return runner_of_(job.project).Run(job, progress);
          },
          [this, on_state = options.on_state](const JobInfo& info, int attempts) {
            CatalogEntry entry{.id = info.id, .record = EncodeRecord(info), .attempts = attempts};
            entry.project = info.project;
            const absl::Status status = files_->store().catalog().Put(EntryKind::kJob, entry);
            if (status.ok() && on_state) on_state(info);
            return status;
          },
          [this](const JobInfo& info) {
            const absl::Status status =
                files_->store().catalog().Delete({EntryKind::kJob, info.project}, info.id);
            return absl::IsNotFound(status) ? absl::OkStatus() : status;
          }) {}

absl::Status JobPool::Start() {
  PLEAT_RETURN_IF_ERROR(Restore());
  manager_.Start();
  return absl::OkStatus();
}

absl::Status JobPool::Restore() {
  Store& store = files_->store();
  PLEAT_ASSIGN_OR_RETURN(const std::vector<CatalogEntry> entries,
                         store.catalog().List(EntryKind::kJob));
  // The rigs of jobs are deleted here and nowhere else: those that no unfinished job needs any
  // more, and those whose job was never created because the process ended in between.
  std::vector<StoredJob> jobs;
  std::set<std::pair<std::string, std::string>> needed_rigs;  // project and id
  bool all_rows_are_read = true;
  for (const CatalogEntry& entry : entries) {
    absl::StatusOr<JobInfo> info = InfoOf<JobInfo>(entry);
    if (!info.ok()) {
      files_->ReportBadRow(EntryKind::kJob, entry.id, info.status());
      all_rows_are_read = false;
      continue;
    }
    if (!IsFinal(info->state)) needed_rigs.emplace(info->project, info->rig_id);
    jobs.push_back({*std::move(info), entry.attempts});
  }
  PLEAT_ASSIGN_OR_RETURN(const std::vector<CatalogEntry> rigs,
                         store.catalog().List(EntryKind::kRig));
  for (const CatalogEntry& rig : rigs) {
    // A job whose row cannot be read may need any of them.
    if (needed_rigs.contains({rig.project, rig.id}) || !all_rows_are_read) continue;
    if (const absl::Status status = store.Delete({EntryKind::kRig, rig.project}, rig.id);
        !status.ok()) {
      store.Report(absl::StrCat("the rig '", rig.id, "' of an ended job cannot be removed: ",
                                std::string(status.message())));
    }
  }
  manager_.Restore(std::move(jobs));
  return absl::OkStatus();
}

JobsOfRetention JobPool::retention() {
  return {.ended = [this]() -> absl::StatusOr<std::vector<EndedJob>> {
            std::vector<EndedJob> ended;
            manager_.Visit([&](const JobInfo& job) {
              if (IsFinal(job.state)) ended.push_back({job.id, job.name, job.ended, job.project});
            });
            return ended;
          },
          .remove = [this](const EndedJob& job) { return manager_.Delete(job.id); },
          .sequences_in_use = [this]() -> absl::StatusOr<std::set<SequenceOfProject>> {
            std::set<SequenceOfProject> in_use;
            manager_.Visit([&](const JobInfo& job) { AddSequencesInUse(job, &in_use); });
            return in_use;
          }};
}

}  // namespace pleat
