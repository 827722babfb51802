#include "pleat/local/local_jobs.h"

#include <utility>

#include "absl/strings/str_cat.h"
#include "pleat/base/sha256.h"
#include "pleat/base/status.h"
#include "pleat/character/train_with_rig.h"
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

absl::Status LocalJobs::CheckProject() {
  PLEAT_RETURN_IF_ERROR(files_->ReserveRoom(1).status());  // for the result
  return job_time_ == nullptr ? absl::OkStatus() : job_time_->Take(0);
}

absl::StatusOr<JobInfo> LocalJobs::CreateTraining(const TrainingRequest& request) {
  PLEAT_RETURN_IF_ERROR(request.rig.empty() ? ValidateTrainOptions(request.options)
                                            : CheckOptionsWithRig(request.options));
  const size_t num_clips = request.sequence_ids.size();
  if (num_clips == 0 || num_clips > static_cast<size_t>(files_->limits().max_clips)) {
    return absl::InvalidArgumentError(absl::StrCat(
        "a training job needs 1 to ", files_->limits().max_clips, " sequences, not ", num_clips));
  }
  PLEAT_RETURN_IF_ERROR(CheckProject());
  JobInfo draft;
  draft.project = files_->project();
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
  return pool_->manager().Create(std::move(draft));
}

absl::StatusOr<JobInfo> LocalJobs::CreateCompression(const CompressionRequest& request) {
  PLEAT_RETURN_IF_ERROR(ValidateCompressOptions(request.options));
  PLEAT_ASSIGN_OR_RETURN(SequenceInfo info, sequences_->Get(request.sequence_id));
  PLEAT_RETURN_IF_ERROR(runner_.CheckMemory(request.options, {info}));
  PLEAT_RETURN_IF_ERROR(CheckProject());
  JobInfo draft;
  draft.project = files_->project();
  draft.sequence_ids = {request.sequence_id};
  draft.options = request.options;
  draft.request_id = request.request_id;
  draft.client = request.client;
  draft.result_ttl = request.result_ttl;
  draft.name = std::move(info.name);
  return pool_->manager().Create(std::move(draft));
}

absl::StatusOr<JobInfo> LocalJobs::Get(const std::string& id) {
  return pool_->manager().Get(id, files_->project());
}

absl::StatusOr<Page<JobInfo>> LocalJobs::ListPage(const PageRequest& request) {
  PLEAT_ASSIGN_OR_RETURN(Page<JobInfo> page, ListStoredPage<JobInfo>(files_, request));
  // The rows give the order; how far a job is that has not ended, the manager knows better.
  for (JobInfo& info : page.items) {
    if (IsFinal(info.state)) continue;
    if (absl::StatusOr<JobInfo> now = Get(info.id); now.ok()) info = *std::move(now);
  }
  return page;
}

absl::Status LocalJobs::Cancel(const std::string& id) {
  return pool_->manager().Cancel(id, files_->project());
}

absl::Status LocalJobs::Delete(const std::string& id) {
  return pool_->manager().Delete(id, files_->project());
}

absl::StatusOr<std::unique_ptr<JobSubscription>> LocalJobs::Subscribe(
    const std::string& id, std::function<void()> listener) {
  PLEAT_ASSIGN_OR_RETURN(std::shared_ptr<JobStateMachine> job,
                         pool_->manager().Find(id, files_->project()));
  return std::make_unique<LocalSubscription>(&pool_->manager(), std::move(job),
                                             std::move(listener));
}

}  // namespace pleat
