#include "pleat/local/local_jobs.h"

#include <set>
#include <utility>

#include "absl/strings/str_cat.h"
#include "pleat/base/sha256.h"
#include "pleat/base/status.h"
#include "pleat/character/train_with_rig.h"
#include "pleat/store/records.h"
#include "stored_infos.h"

namespace pleat {
namespace {

// Checks what can be said about a rig before its mesh is read, so that a wrong rig is refused when
// the job is created and not when it runs.
absl::Status CheckRigCounts(const RigFile& rig, const SequenceInfo& clip) {
  if (rig.rest_frame >= clip.num_frames) {
    return absl::InvalidArgumentError(absl::StrCat("rig: rest_frame ", rig.rest_frame, " of '",
                                                   clip.name, "', which has ", clip.num_frames,
                                                   " frames"));
  }
  if (!rig.influences.empty() && rig.influences.size() != static_cast<size_t>(clip.num_vertices)) {
    return absl::InvalidArgumentError(absl::StrCat("rig: weights of ", rig.influences.size(),
                                                   " vertices; '", clip.name, "' has ",
                                                   clip.num_vertices));
  }
  return absl::OkStatus();
}

// One observer of one job. It shares the job with the manager, which must outlive it.
class LocalSubscription final : public JobSubscription {
 public:
  LocalSubscription(const JobManager* manager, std::shared_ptr<JobStateMachine> job,
                    std::function<void()> listener)
      : manager_(manager), job_(std::move(job)), token_(job_->AddListener(std::move(listener))) {}
  ~LocalSubscription() override { job_->RemoveListener(token_); }

  JobUpdate current() const override {
    JobSnapshot snapshot = job_->snapshot();
    return {std::move(snapshot.info), snapshot.revision};
  }
  absl::Status status() const override {
    if (!manager_->shutting_down()) return absl::OkStatus();
    return absl::UnavailableError("the service is shutting down");
  }

 private:
  const JobManager* const manager_;
  const std::shared_ptr<JobStateMachine> job_;
  const int token_;
};

}  // namespace

LocalJobs::LocalJobs(StoredFiles* files, LocalSequences* sequences, JobRunner runner,
                     const LocalJobsOptions& options)
    : files_(files),
      sequences_(sequences),
      runner_(std::move(runner)),
      manager_(
          JobManagerOptions{.num_workers = options.num_workers,
                            .max_queued_per_client = options.max_queued_per_client,
                            .in_idle_time = options.in_idle_time,
                            .wall_clock = files->clock()},
          [this](const JobInfo& job, const Progress& progress) {
            return runner_.Run(job, progress);
          },
          [this, on_state = options.on_state](const JobInfo& info, int attempts) {
            const absl::Status status =
                files_->catalog().Put(EntryKind::kJob, {info.id, EncodeRecord(info), attempts});
            if (status.ok() && on_state) on_state(info);
            return status;
          },
          [this](const std::string& id) {
            const absl::Status status = files_->catalog().Delete(EntryKind::kJob, id);
            return absl::IsNotFound(status) ? absl::OkStatus() : status;
          }) {}

absl::Status LocalJobs::Start() {
  PLEAT_RETURN_IF_ERROR(Restore());
  manager_.Start();
  return absl::OkStatus();
}

absl::Status LocalJobs::Restore() {
  PLEAT_ASSIGN_OR_RETURN(const std::vector<CatalogEntry> entries,
                         files_->catalog().List(EntryKind::kJob));
  // The rigs of jobs are deleted here and nowhere else: those that no unfinished job needs any
  // more, and those whose job was never created because the process ended in between.
  std::vector<StoredJob> jobs;
  std::set<std::string> needed_rigs;
  bool all_rows_are_read = true;
  for (const CatalogEntry& entry : entries) {
    absl::StatusOr<JobInfo> info = DecodeJobRecord(entry.record);
    if (!info.ok()) {
      files_->ReportBadRow(EntryKind::kJob, entry.id, info.status());
      all_rows_are_read = false;
      continue;
    }
    if (!IsFinal(info->state)) needed_rigs.insert(info->rig_id);
    jobs.push_back({*std::move(info), entry.attempts});
  }
  PLEAT_ASSIGN_OR_RETURN(const std::vector<CatalogEntry> rigs,
                         files_->catalog().List(EntryKind::kRig));
  for (const CatalogEntry& rig : rigs) {
    // A job whose row cannot be read may need any of them.
    if (needed_rigs.contains(rig.id) || !all_rows_are_read) continue;
    if (const absl::Status status = files_->Delete(EntryKind::kRig, rig.id); !status.ok()) {
      files_->store().Report(
          absl::StrCat("the rig '", rig.id,
                       "' of an ended job cannot be removed: ", std::string(status.message())));
    }
  }
  manager_.Restore(std::move(jobs));
  return absl::OkStatus();
}

absl::StatusOr<JobInfo> LocalJobs::CreateTraining(const TrainingRequest& request) {
  PLEAT_RETURN_IF_ERROR(request.rig.empty() ? ValidateTrainOptions(request.options)
                                            : CheckOptionsWithRig(request.options));
  const size_t num_clips = request.sequence_ids.size();
  if (num_clips == 0 || num_clips > static_cast<size_t>(files_->limits().max_clips)) {
    return absl::InvalidArgumentError(absl::StrCat(
        "a training job needs 1 to ", files_->limits().max_clips, " sequences, not ", num_clips));
  }
  JobInfo draft;
  std::vector<SequenceInfo> clips;
  for (const std::string& id : request.sequence_ids) {
    PLEAT_ASSIGN_OR_RETURN(SequenceInfo info, sequences_->Get(id));
    clips.push_back(std::move(info));
  }
  PLEAT_RETURN_IF_ERROR(runner_.CheckMemory(request.options, clips));
  draft.sequence_ids = request.sequence_ids;
  draft.options = request.options;
  draft.request_id = request.request_id;
  draft.client = request.client;
  draft.result_ttl = request.model_ttl;
  draft.name = request.model_name.empty() ? clips[0].name : request.model_name;
  if (!request.rig.empty()) {
    PLEAT_ASSIGN_OR_RETURN(const RigFile rig, runner_.DecodeUserRig(request.rig));
    PLEAT_RETURN_IF_ERROR(CheckRigCounts(rig, clips[0]));
    // The rig is stored before the job, so that a job that exists finds its rig.
    draft.rig_id = ToHex(ComputeSha256(request.rig));
    PLEAT_RETURN_IF_ERROR(files_->Add(EntryKind::kRig, {draft.rig_id, ""}, request.rig));
  }
  return manager_.Create(std::move(draft));
}

absl::StatusOr<JobInfo> LocalJobs::CreateCompression(const CompressionRequest& request) {
  PLEAT_RETURN_IF_ERROR(ValidateCompressOptions(request.options));
  PLEAT_ASSIGN_OR_RETURN(SequenceInfo info, sequences_->Get(request.sequence_id));
  PLEAT_RETURN_IF_ERROR(runner_.CheckMemory(request.options, {info}));
  JobInfo draft;
  draft.sequence_ids = {request.sequence_id};
  draft.options = request.options;
  draft.request_id = request.request_id;
  draft.client = request.client;
  draft.result_ttl = request.result_ttl;
  draft.name = std::move(info.name);
  return manager_.Create(std::move(draft));
}

absl::StatusOr<JobInfo> LocalJobs::Get(const std::string& id) { return manager_.Get(id); }

absl::StatusOr<Page<JobInfo>> LocalJobs::ListPage(const PageRequest& request) {
  PLEAT_ASSIGN_OR_RETURN(Page<JobInfo> page, ListStoredPage<JobInfo>(files_, request));
  // The rows give the order; how far a job is, the manager knows better.
  for (JobInfo& info : page.items) {
    if (absl::StatusOr<JobInfo> now = manager_.Get(info.id); now.ok()) info = *std::move(now);
  }
  return page;
}

JobsOfRetention LocalJobs::retention() {
  return {.ended = [this]() -> absl::StatusOr<std::vector<EndedJob>> {
            std::vector<EndedJob> ended;
            manager_.Visit([&](const JobInfo& job) {
              if (IsFinal(job.state)) ended.push_back({job.id, job.name, job.ended});
            });
            return ended;
          },
          .remove = [this](const std::string& id) { return manager_.Delete(id); },
          .sequences_in_use = [this]() -> absl::StatusOr<std::set<std::string>> {
            std::set<std::string> ids;
            manager_.Visit([&](const JobInfo& job) {
              if (!IsFinal(job.state)) ids.insert(job.sequence_ids.begin(), job.sequence_ids.end());
            });
            return ids;
          }};
}

absl::Status LocalJobs::Cancel(const std::string& id) { return manager_.Cancel(id); }

absl::Status LocalJobs::Delete(const std::string& id) { return manager_.Delete(id); }

absl::StatusOr<std::unique_ptr<JobSubscription>> LocalJobs::Subscribe(
    const std::string& id, std::function<void()> listener) {
  PLEAT_ASSIGN_OR_RETURN(std::shared_ptr<JobStateMachine> job, manager_.Find(id));
  return std::make_unique<LocalSubscription>(&manager_, std::move(job), std::move(listener));
}

}  // namespace pleat
