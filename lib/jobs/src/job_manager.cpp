#include "pleat/jobs/job_manager.h"

#include <algorithm>
#include <chrono>
#include <exception>
#include <utility>

#include "absl/strings/str_cat.h"
#include "pleat/base/limit_refusal.h"
#include "pleat/base/random_id.h"
#include "pleat/base/status.h"
#include "pleat/base/thread_priority.h"

namespace pleat {
namespace {

// Jobs take seconds to minutes, so places in the queue become free at that pace.
constexpr absl::Duration kRetryAfter = absl::Seconds(10);

// Two projects may choose the same request id, and neither must notice.
std::string RequestKey(const JobInfo& info) {
  return absl::StrCat(info.project, "\n", info.request_id);
}

std::string MakeJobId() { return "job-" + RandomHexId(2); }

// How long a job is in each of its stages.
class StageClock {
 public:
  explicit StageClock(const JobManagerOptions& options) : options_(options) {}
  ~StageClock() { Enter(""); }

  void Enter(const std::string& stage) {
    if (!options_.on_stage) return;
    std::lock_guard lock(mutex_);
    if (stage == stage_) return;
    const double now = options_.clock();
    if (!stage_.empty()) options_.on_stage(stage_, now - since_);
    stage_ = stage;
    since_ = now;
  }

 private:
  const JobManagerOptions& options_;
  std::mutex mutex_;
  std::string stage_;  // guarded by mutex_, as is the next; empty before the first
  double since_ = 0;
};

}  // namespace

JobManager::JobManager(JobManagerOptions options, RunJob run, SaveJob save, EraseJob erase)
    : options_(std::move(options)),
      run_(std::move(run)),
      save_(std::move(save)),
      erase_(std::move(erase)) {}

JobManager::~JobManager() { Shutdown(); }

void JobManager::Restore(std::vector<StoredJob> jobs) {
  const auto num_were_running = std::ranges::count(
      jobs, JobState::kRunning, [](const StoredJob& stored) { return stored.info.state; });
  for (StoredJob& stored : jobs) {
    if (stored.info.state == JobState::kRunning) {
      RestoreRunning({std::move(stored.info), stored.attempts, 0}, num_were_running == 1);
      continue;
    }
    auto job =
        std::make_shared<JobStateMachine>(std::move(stored.info), stored.attempts, options_.clock);
    std::lock_guard lock(mutex_);
    Register(std::move(job));
  }
}

void JobManager::RestoreRunning(JobSnapshot snapshot, bool ran_alone) {
  // The attempt was counted when it began. Only of a job that ran alone is it known what it did.
  if (!ran_alone && snapshot.attempts > 0) --snapshot.attempts;
  snapshot.info.fraction = 0;
  const bool is_hopeless = ran_alone && snapshot.attempts >= options_.max_attempts;
  if (!is_hopeless) {
    snapshot.info.state = JobState::kQueued;
    snapshot.info.started.reset();
  }
  auto job = std::make_shared<JobStateMachine>(snapshot.info, snapshot.attempts, options_.clock);
  if (is_hopeless) {
    job->Fail(
        absl::AbortedError(absl::StrCat(
            "the server stopped ", snapshot.attempts,
            " times while this job was running alone; it may need more memory than there is")),
        options_.wall_clock());
  }
  Save(job.get());
  std::lock_guard lock(mutex_);
  if (!is_hopeless) suspects_.insert(job->id());
  Register(std::move(job));
}

void JobManager::Register(std::shared_ptr<JobStateMachine> job) {
  const JobInfo info = job->snapshot().info;
  const uint64_t number = next_number_++;
  order_.emplace(number, info.id);
  if (!info.request_id.empty()) ids_by_request_.emplace(RequestKey(info), info.id);
  if (info.state == JobState::kQueued) queue_.Add(job, info.client);
  jobs_.emplace(info.id, Registered{std::move(job), number});
}

void JobManager::Start() {
  for (int i = 0; i < std::max(1, options_.num_workers); ++i) {
    workers_.emplace_back([this] { Work(); });
  }
}

absl::StatusOr<std::shared_ptr<JobStateMachine>> JobManager::FindRequest(
    const JobInfo& draft) const {
  const auto id = ids_by_request_.find(RequestKey(draft));
  if (id == ids_by_request_.end()) return nullptr;
  const std::shared_ptr<JobStateMachine>& job = jobs_.at(id->second).job;
  const JobInfo info = job->snapshot().info;
  if (info.sequence_ids != draft.sequence_ids || info.options.index() != draft.options.index()) {
    return absl::AlreadyExistsError(absl::StrCat("the request_id of this call made job '", info.id,
                                                 "', which works on something else; choose request "
                                                 "ids at random"));
  }
  return job;
}

absl::StatusOr<JobInfo> JobManager::Create(JobInfo draft) {
  draft.id = MakeJobId();
  draft.state = JobState::kQueued;
  draft.created = options_.wall_clock();
  auto job = std::make_shared<JobStateMachine>(draft, 0, options_.clock);
  std::lock_guard creating(create_mutex_);
  {
    std::lock_guard lock(mutex_);
    if (shutting_down()) return absl::UnavailableError("the server is shutting down");
    PLEAT_ASSIGN_OR_RETURN(const std::shared_ptr<JobStateMachine> known, FindRequest(draft));
    if (known != nullptr) return known->snapshot().info;
    PLEAT_RETURN_IF_ERROR(CheckQueue(draft));
  }
  // Saved first: a job that was accepted is never lost. Saving waits for the disk, so those who ask
  // for jobs must not wait for it.
  PLEAT_RETURN_IF_ERROR(save_(draft, 0));
  {
    std::lock_guard lock(mutex_);
    Register(std::move(job));
  }
  changed_.notify_all();  // one that may not take it would keep the word to itself
  return draft;
}

absl::Status JobManager::CheckQueue(const JobInfo& draft) const {
  if (static_cast<int>(queue_.size()) >= options_.max_queued) {
    return RefuseForLimit({.limit = "waiting jobs", .retry_after = kRetryAfter},
                          absl::StrCat(queue_.size(), " jobs are waiting, the limit is ",
                                       options_.max_queued, "; try again later"));
  }
  if (queue_.NumOf(draft.client) >= options_.max_queued_per_client) {
    return RefuseForLimit(
        {.subject = kClientLimit,
         .limit = "--max-queued-jobs-per-client",
         .retry_after = kRetryAfter},
        absl::StrCat("this client has ", options_.max_queued_per_client,
                     " waiting jobs, which is its limit; try again when some of them have run"));
  }
  const int per_project = options_.max_queued_per_project;
  if (per_project > 0 && queue_.NumOfProject(draft.project) >= per_project) {
    return RefuseForLimit(
        {.subject = absl::StrCat("project:", draft.project),
         .limit = "--project-queued-jobs",
         .retry_after = kRetryAfter},
        absl::StrCat("the project '", draft.project, "' has ", per_project,
                     " waiting jobs, which is its limit; try again when some of them have run"));
  }
  return absl::OkStatus();
}

absl::StatusOr<std::shared_ptr<JobStateMachine>> JobManager::Find(const std::string& id) const {
  std::lock_guard lock(mutex_);
  const auto it = jobs_.find(id);
  if (it == jobs_.end()) return absl::NotFoundError(absl::StrCat("no job '", id, "'"));
  return it->second.job;
}

absl::StatusOr<JobInfo> JobManager::Get(const std::string& id) const {
  PLEAT_ASSIGN_OR_RETURN(const std::shared_ptr<JobStateMachine> job, Find(id));
  return job->snapshot().info;
}

void JobManager::Visit(const std::function<void(const JobInfo&)>& visit) const {
  std::lock_guard lock(mutex_);
  for (const auto& [number, id] : order_) visit(jobs_.at(id).job->snapshot().info);
}

std::vector<JobInfo> JobManager::List() const {
  std::vector<JobInfo> jobs;
  Visit([&](const JobInfo& job) { jobs.push_back(job); });
  return jobs;
}

size_t JobManager::CountInState(JobState state) const {
  std::lock_guard lock(mutex_);
  return static_cast<size_t>(std::ranges::count_if(
      jobs_, [state](const auto& entry) { return entry.second.job->state() == state; }));
}

absl::Status JobManager::Cancel(const std::string& id) {
  PLEAT_ASSIGN_OR_RETURN(const std::shared_ptr<JobStateMachine> job, Find(id));
  bool was_waiting = false;
  {
    std::lock_guard lock(mutex_);
    was_waiting = queue_.Remove(job);
  }
  const absl::Time now = options_.wall_clock();
  if (!was_waiting) return job->RequestCancel(now);  // its worker saves how it ends
  const JobSnapshot snapshot = job->snapshot();
  JobStateMachine draft(snapshot.info, snapshot.attempts, options_.clock);
  absl::Status status = draft.RequestCancel(now);
  if (status.ok()) status = save_(draft.snapshot().info, snapshot.attempts);
  if (!status.ok()) {
    {
      std::lock_guard lock(mutex_);
      queue_.AddFirst(job, snapshot.info.client);
    }
    changed_.notify_all();
    return status;
  }
  return job->RequestCancel(now);
}

absl::Status JobManager::Delete(const std::string& id) {
  std::lock_guard erasing(erase_mutex_);
  PLEAT_ASSIGN_OR_RETURN(const std::shared_ptr<JobStateMachine> job, Find(id));
  const JobInfo info = job->snapshot().info;
  if (!IsFinal(info.state)) {
    return absl::FailedPreconditionError(
        absl::StrCat("job '", id, "' is ", JobStateName(info.state),
                     "; only jobs that have ended are deleted, so cancel it first"));
  }
  PLEAT_RETURN_IF_ERROR(erase_(info));
  std::lock_guard lock(mutex_);
  const auto registered = jobs_.find(id);
  order_.erase(registered->second.number);
  jobs_.erase(registered);
  const auto request = ids_by_request_.find(RequestKey(info));
  if (request != ids_by_request_.end() && request->second == id) ids_by_request_.erase(request);
  return absl::OkStatus();
}

void JobManager::Shutdown() {
  {
    std::lock_guard lock(mutex_);
    shutting_down_ = true;
  }
  changed_.notify_all();
  stopped_.notify_all();
  for (std::thread& worker : workers_) worker.join();
  workers_.clear();
  // Those who watch a job that still waits learn that nothing more will come.
  std::vector<std::shared_ptr<JobStateMachine>> waiting;
  {
    std::lock_guard lock(mutex_);
    waiting = queue_.jobs();
  }
  for (const auto& job : waiting) job->Wake();
}

bool JobManager::MayStartNext() const {
  if (queue_.empty() || runs_suspect_) return false;
  return num_running_ == 0 || !suspects_.contains(queue_.next()->id());
}

std::shared_ptr<JobStateMachine> JobManager::TakeNext() {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [this] { return shutting_down() || MayStartNext(); });
  if (shutting_down()) return nullptr;
  std::shared_ptr<JobStateMachine> job = queue_.Take();
  ++num_running_;
  runs_suspect_ = suspects_.erase(job->id()) > 0;
  return job;
}

void JobManager::Work() {
  if (options_.in_idle_time) RunInIdleTime();
  while (const std::shared_ptr<JobStateMachine> job = TakeNext()) {
    if (job->Start(options_.wall_clock())) {
      Save(job.get());
      RunOne(job.get());
    } else {
      SaveUnlessDeleted(job.get());  // cancelled in this moment
    }
    {
      std::lock_guard lock(mutex_);
      --num_running_;
      if (num_running_ == 0) runs_suspect_ = false;
    }
    changed_.notify_all();
  }
}

void JobManager::RunOne(JobStateMachine* job) {
  StageClock stages(options_);
  const Progress progress(
      [job, &stages](const ProgressUpdate& update) {
        stages.Enter(update.stage);
        job->Report(update);
      },
      [this, job] { return shutting_down() || job->cancel_requested(); });
  absl::StatusOr<JobOutcome> outcome = absl::UnknownError("the job did not run");
  try {
    outcome = run_(job->snapshot().info, progress);
  } catch (const std::bad_alloc&) {
    outcome = absl::ResourceExhaustedError(
        "the server has not enough memory for this job; use fewer frames or a lower resolution");
  } catch (const std::exception&) {
    // Its text is for programmers and may name anything.
    outcome = absl::InternalError("the job ended with an exception: a fault of Pleat");
  }
  const absl::Time now = options_.wall_clock();
  if (outcome.ok()) {
    End(job, [&](JobStateMachine* it) {
      return it->Succeed(outcome->result_id, outcome->warnings, now);
    });
  } else if (outcome.status().code() != absl::StatusCode::kCancelled) {
    End(job, [&](JobStateMachine* it) { return it->Fail(outcome.status(), now); });
  } else if (job->cancel_requested()) {
    End(job, [&](JobStateMachine* it) { return it->Cancelled(now); });
  } else {
    job->Requeue();          // the server shuts down; the next process goes on
    SaveUnlessDeleted(job);  // it waits again, so it can be cancelled and deleted
  }
}

void JobManager::End(JobStateMachine* job, const EndJob& end) {
  const JobSnapshot snapshot = job->snapshot();
  JobStateMachine draft(snapshot.info, snapshot.attempts, options_.clock);
  if (!end(&draft)) return;
  if (SaveUntilDone(job, draft.snapshot())) {
    end(job);
  } else {
    job->Requeue();  // the store still says that it runs, so the next process runs it again
  }
}

bool JobManager::SaveUntilDone(JobStateMachine* job, const JobSnapshot& ended) {
  for (bool is_first = true;; is_first = false) {
    const absl::Status status = save_(ended.info, ended.attempts);
    if (status.ok()) return true;
    if (is_first) {
      job->AddWarning(absl::StrCat("how the job ended cannot be saved yet: ",
                                   absl::string_view(status.message())));
    }
    std::unique_lock lock(mutex_);
    const std::chrono::duration<double> pause(options_.save_retry_seconds);
    if (stopped_.wait_for(lock, pause, [this] { return shutting_down(); })) return false;
  }
}

void JobManager::SaveUnlessDeleted(JobStateMachine* job) {
  std::lock_guard erasing(erase_mutex_);
  if (Find(job->id()).ok()) Save(job);
}

void JobManager::Save(JobStateMachine* job) {
  const JobSnapshot snapshot = job->snapshot();
  if (absl::Status status = save_(snapshot.info, snapshot.attempts); !status.ok()) {
    job->AddWarning(absl::StrCat("the state of the job could not be saved: ",
                                 absl::string_view(status.message())));
  }
}

}  // namespace pleat
