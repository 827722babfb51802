#include "pleat/jobs/job_manager.h"

#include <algorithm>
#include <exception>
#include <random>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "pleat/base/status.h"
#include "pleat/base/thread_priority.h"

namespace pleat {
namespace {

std::string MakeJobId() {
  std::random_device device;
  return absl::StrFormat("job-%08x%08x", device(), device());
}

}  // namespace

JobManager::JobManager(JobManagerOptions options, RunJob run, SaveJob save)
    : options_(std::move(options)), run_(std::move(run)), save_(std::move(save)) {}

JobManager::~JobManager() { Shutdown(); }

void JobManager::Restore(std::vector<StoredJob> jobs) {
  for (StoredJob& stored : jobs) {
    const bool was_running = stored.info.state == JobState::kRunning;
    const std::string id = stored.info.id;
    auto job =
        std::make_shared<JobStateMachine>(std::move(stored.info), stored.attempts, options_.clock);
    if (was_running && stored.attempts >= options_.max_attempts) {
      job->Fail(absl::AbortedError(absl::StrCat(
          "the server stopped ", stored.attempts,
          " times while this job was running; it may need more memory than there is")));
      Save(job.get());
    } else if (was_running) {
      // Requeue does not count the attempt, but this one took the server down.
      JobSnapshot snapshot = job->snapshot();
      snapshot.info.state = JobState::kQueued;
      snapshot.info.fraction = 0;
      job = std::make_shared<JobStateMachine>(snapshot.info, snapshot.attempts, options_.clock);
      Save(job.get());
    }
    std::lock_guard lock(mutex_);
    order_.push_back(id);
    if (job->snapshot().info.state == JobState::kQueued) queue_.push_back(job);
    jobs_.emplace(id, std::move(job));
  }
}

void JobManager::Start() {
  for (int i = 0; i < std::max(1, options_.num_workers); ++i) {
    workers_.emplace_back([this] { Work(); });
  }
}

absl::StatusOr<JobInfo> JobManager::Create(JobInfo draft) {
  draft.id = MakeJobId();
  draft.state = JobState::kQueued;
  auto job = std::make_shared<JobStateMachine>(draft, 0, options_.clock);
  std::lock_guard creating(create_mutex_);
  {
    std::lock_guard lock(mutex_);
    if (shutting_down()) return absl::UnavailableError("the server is shutting down");
    if (static_cast<int>(queue_.size()) >= options_.max_queued) {
      return absl::ResourceExhaustedError(absl::StrCat(queue_.size(),
                                                       " jobs are waiting, the limit is ",
                                                       options_.max_queued, "; try again later"));
    }
  }
  // Saved first: a job that was accepted is never lost. Saving waits for the disk, so those who ask
  // for jobs must not wait for it.
  PLEAT_RETURN_IF_ERROR(save_(draft, 0));
  {
    std::lock_guard lock(mutex_);
    jobs_.emplace(draft.id, job);
    order_.push_back(draft.id);
    queue_.push_back(job);
  }
  changed_.notify_one();
  return draft;
}

absl::StatusOr<std::shared_ptr<JobStateMachine>> JobManager::Find(const std::string& id) const {
  std::lock_guard lock(mutex_);
  const auto it = jobs_.find(id);
  if (it == jobs_.end()) return absl::NotFoundError(absl::StrCat("no job '", id, "'"));
  return it->second;
}

absl::StatusOr<JobInfo> JobManager::Get(const std::string& id) const {
  PLEAT_ASSIGN_OR_RETURN(const std::shared_ptr<JobStateMachine> job, Find(id));
  return job->snapshot().info;
}

std::vector<JobInfo> JobManager::List() const {
  std::lock_guard lock(mutex_);
  std::vector<JobInfo> jobs;
  for (const std::string& id : order_) jobs.push_back(jobs_.at(id)->snapshot().info);
  return jobs;
}

absl::Status JobManager::Cancel(const std::string& id) {
  PLEAT_ASSIGN_OR_RETURN(const std::shared_ptr<JobStateMachine> job, Find(id));
  PLEAT_RETURN_IF_ERROR(job->RequestCancel());
  bool was_waiting = false;
  {
    std::lock_guard lock(mutex_);
    was_waiting = std::erase(queue_, job) > 0;
  }
  if (was_waiting) Save(job.get());  // nobody else has it any more
  return absl::OkStatus();
}

void JobManager::Shutdown() {
  {
    std::lock_guard lock(mutex_);
    shutting_down_ = true;
  }
  changed_.notify_all();
  for (std::thread& worker : workers_) worker.join();
  workers_.clear();
  // Those who watch a job that still waits learn that nothing more will come.
  std::vector<std::shared_ptr<JobStateMachine>> waiting;
  {
    std::lock_guard lock(mutex_);
    waiting.assign(queue_.begin(), queue_.end());
  }
  for (const auto& job : waiting) job->Wake();
}

void JobManager::Work() {
  if (options_.in_idle_time) RunInIdleTime();
  while (true) {
    std::shared_ptr<JobStateMachine> job;
    {
      std::unique_lock lock(mutex_);
      changed_.wait(lock, [this] { return shutting_down() || !queue_.empty(); });
      if (shutting_down()) return;
      job = std::move(queue_.front());
      queue_.pop_front();
    }
    if (job->Start()) {
      Save(job.get());
      RunOne(job.get());
    }
    Save(job.get());
  }
}

void JobManager::RunOne(JobStateMachine* job) {
  const Progress progress([job](const ProgressUpdate& update) { job->Report(update); },
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
  if (outcome.ok()) {
    job->Succeed(outcome->result_id, outcome->warnings);
  } else if (outcome.status().code() != absl::StatusCode::kCancelled) {
    job->Fail(outcome.status());
  } else if (job->cancel_requested()) {
    job->Cancelled();
  } else {
    job->Requeue();  // the server shuts down; the next process goes on
  }
}

void JobManager::Save(JobStateMachine* job) {
  const JobSnapshot snapshot = job->snapshot();
  if (absl::Status status = save_(snapshot.info, snapshot.attempts); !status.ok()) {
    job->AddWarning(absl::StrCat("the state of the job could not be saved: ",
                                 absl::string_view(status.message())));
  }
}

}  // namespace pleat
