#include "pleat/local/job_pool.h"

#include <set>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "job_rows.h"
#include "pleat/base/status.h"
#include "pleat/store/records.h"

namespace pleat {

JobPool::JobPool(StoredFiles* files, RunnerOf runner_of, const JobPoolOptions& options)
    : files_(files),
      runner_of_(std::move(runner_of)),
      journal_(std::make_unique<JobRows>(files, options.on_state)),
      manager_(
          JobManagerOptions{.num_workers = options.num_workers,
                            .max_queued_per_client = options.max_queued_per_client,
                            .max_queued_per_project = options.max_queued_per_project,
                            .in_idle_time = options.in_idle_time,
                            .on_stage = options.on_stage,
                            .on_processor_time = options.on_processor_time,
                            .waiting_time = options.waiting_time,
                            .wall_clock = files->clock()},
          [this](const JobInfo& job, const Progress& progress) {
            return runner_of_(job.project).Run(job, progress);
          },
          journal_.get()) {}

absl::Status JobPool::Start() {
  PLEAT_RETURN_IF_ERROR(Restore());
  manager_.Start();
  return absl::OkStatus();
}

absl::Status JobPool::Restore() {
  PLEAT_ASSIGN_OR_RETURN(UnfinishedJobs unfinished, ReadUnfinishedJobs(files_));
  // A job whose row cannot be read may need any of the files.
  if (unfinished.all_rows_are_read) PLEAT_RETURN_IF_ERROR(RemoveFilesOfEndedJobs(unfinished));
  manager_.Restore(std::move(unfinished.jobs));
  return absl::OkStatus();
}

absl::Status JobPool::RemoveFilesOfEndedJobs(const UnfinishedJobs& unfinished) {
  using FileOfProject = std::pair<std::string, std::string>;
  std::set<FileOfProject> needed_rigs, unfinished_ids;
  for (const StoredJob& job : unfinished.jobs) {
    needed_rigs.emplace(job.info.project, job.info.rig_id);
    unfinished_ids.emplace(job.info.project, job.info.id);
  }
  Store& store = files_->store();
  const auto remove = [&store](EntryKind kind, const CatalogEntry& entry) {
    const absl::Status status = store.Delete({kind, entry.project}, entry.id);
    if (status.ok()) return;
    store.Report(
        absl::StrCat("the ", EntryKindName(kind), " '", entry.id,
                     "' of an ended job cannot be removed: ", std::string(status.message())));
  };
  // Rigs are deleted here and nowhere else: those that no unfinished job needs any more, and those
  // whose job was never created because the process ended in between.
  PLEAT_ASSIGN_OR_RETURN(const std::vector<CatalogEntry> rigs,
                         store.catalog().List(EntryKind::kRig));
  for (const CatalogEntry& rig : rigs) {
    if (!needed_rigs.contains({rig.project, rig.id})) remove(EntryKind::kRig, rig);
  }
  // Checkpoints go with the end of their job, unless the process ended in between.
  PLEAT_ASSIGN_OR_RETURN(const std::vector<CatalogEntry> checkpoints,
                         store.catalog().List(EntryKind::kCheckpoint));
  for (const CatalogEntry& entry : checkpoints) {
    const absl::StatusOr<CheckpointInfo> info = DecodeCheckpointRecord(entry.record);
    if (!info.ok() || !unfinished_ids.contains({entry.project, info->job_id})) {
      remove(EntryKind::kCheckpoint, entry);
    }
  }
  return absl::OkStatus();
}

size_t JobPool::CountInState(JobState state) const {
  const auto counts = files_->store().catalog().CountJobs();
  if (!counts.ok()) return 0;
  size_t num = 0;
  for (const Catalog::JobCount& count : *counts) {
    if (count.state == JobStateName(state)) num += static_cast<size_t>(count.num);
  }
  return num;
}

}  // namespace pleat
