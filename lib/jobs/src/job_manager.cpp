#include "pleat/jobs/job_manager.h"

#include <algorithm>
#include <chrono>
#include <exception>
#include <utility>

#include "absl/strings/str_cat.h"
#include "job_clocks.h"
#include "pleat/base/limit_refusal.h"
#include "pleat/base/random_id.h"
#include "pleat/base/status.h"
#include "pleat/base/thread_priority.h"

namespace pleat {
namespace {

// Jobs take seconds to minutes, so places in the queue become free at that pace.
constexpr absl::Duration kRetryAfter = absl::Seconds(10);

std::string MakeJobId() { return "job-" + RandomHexId(2); }

}  // namespace

JobManager::JobManager(JobManagerOptions options, RunJob run, JobJournal* journal)
    : options_(std::move(options)), run_(std::move(run)), journal_(journal) {}

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
  if (Save(job.get()) && is_hopeless) return;
  std::lock_guard lock(mutex_);
  if (!is_hopeless) suspects_.insert(job->id());
  Register(std::move(job));
}

void JobManager::Register(std::shared_ptr<JobStateMachine> job) {
  const JobInfo info = job->snapshot().info;
  const uint64_t number = next_number_++;
  order_.emplace(number, info.id);
  if (info.state == JobState::kQueued) queue_.Add(job, info.client);
  jobs_.emplace(info.id, Registered{std::move(job), number});
}

void JobManager::Start() {
  for (int i = 0; i < std::max(1, options_.num_workers); ++i) {
    workers_.emplace_back([this] { Work(); });
  }
}

// Every job is in the journal before it can be seen, so the journal alone knows all requests.
absl::StatusOr<std::optional<JobInfo>> JobManager::FindRequest(const JobInfo& draft) const {
  if (draft.request_id.empty()) return std::nullopt;
  const absl::StatusOr<StoredJob> stored = journal_->FindRequest(draft.project, draft.request_id);
  if (absl::IsNotFound(stored.status())) return std::nullopt;
  PLEAT_RETURN_IF_ERROR(stored.status());
  const JobInfo& info = stored->info;
  if (info.sequence_ids != draft.sequence_ids || info.options.index() != draft.options.index()) {
    return absl::AlreadyExistsError(absl::StrCat("the request_id of this call made job '", info.id,
                                                 "', which works on something else; choose request "
                                                 "ids at random"));
  }
  if (const auto job = FindUnfinished(info.id, info.project)) return job->snapshot().info;
  if (IsFinal(info.state)) return info;
  // It has ended in this moment, and may be deleted already.
  absl::StatusOr<StoredJob> ended = journal_->Read(info.project, info.id);
  if (absl::IsNotFound(ended.status())) return std::nullopt;
  PLEAT_RETURN_IF_ERROR(ended.status());
  return std::move(ended->info);
}

absl::StatusOr<JobInfo> JobManager::Create(JobInfo draft) {
  draft.id = MakeJobId();
  draft.state = JobState::kQueued;
  draft.created = options_.wall_clock();
  auto job = std::make_shared<JobStateMachine>(draft, 0, options_.clock);
  std::lock_guard creating(create_mutex_);
  if (shutting_down()) return absl::UnavailableError("the server is shutting down");
  PLEAT_ASSIGN_OR_RETURN(std::optional<JobInfo> known, FindRequest(draft));
  if (known) return *std::move(known);
  {
    std::lock_guard lock(mutex_);
    PLEAT_RETURN_IF_ERROR(CheckQueue(draft));
  }
  // Saved first: a job that was accepted is never lost. Saving waits for the disk, so those who ask
  // for jobs must not wait for it.
  PLEAT_RETURN_IF_ERROR(journal_->Save(draft, 0));
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

std::shared_ptr<JobStateMachine> JobManager::FindUnfinished(const std::string& id,
                                                            const std::string& project) const {
  std::lock_guard lock(mutex_);
  const auto it = jobs_.find(id);
  return it != jobs_.end() && it->second.job->project() == project ? it->second.job : nullptr;
}

absl::StatusOr<std::shared_ptr<JobStateMachine>> JobManager::Find(
    const std::string& id, const std::string& project) const {
  for (const bool is_last : {false, true}) {
    if (std::shared_ptr<JobStateMachine> job = FindUnfinished(id, project)) return job;
    PLEAT_ASSIGN_OR_RETURN(StoredJob stored, journal_->Read(project, id));
    if (IsFinal(stored.info.state) || is_last) {
      return std::make_shared<JobStateMachine>(std::move(stored.info), stored.attempts,
                                               options_.clock);
    }
    // It is saved and not yet known: whoever creates it is about to make it known.
    std::lock_guard created(create_mutex_);
  }
  return absl::InternalError("unreachable");
}

absl::StatusOr<JobInfo> JobManager::Get(const std::string& id, const std::string& project) const {
  PLEAT_ASSIGN_OR_RETURN(const std::shared_ptr<JobStateMachine> job, Find(id, project));
  return job->snapshot().info;
}

std::vector<JobInfo> JobManager::ListUnfinished() const {
  std::vector<JobInfo> jobs;
  std::lock_guard lock(mutex_);
  for (const auto& [number, id] : order_) {
    JobInfo info = jobs_.at(id).job->snapshot().info;
    if (!IsFinal(info.state)) jobs.push_back(std::move(info));
  }
  return jobs;
}

absl::Status JobManager::Cancel(const std::string& id, const std::string& project) {
  PLEAT_ASSIGN_OR_RETURN(const std::shared_ptr<JobStateMachine> job, Find(id, project));
  const absl::Time now = options_.wall_clock();
  {
    std::unique_lock lock(mutex_);
    while (!queue_.Remove(job)) {
      // A worker has it, and saves how it ends; or it has ended.
      if (job->state() != JobState::kQueued) return job->RequestCancel(now);
      if (shutting_down() || !jobs_.contains(id)) {
        return absl::UnavailableError(
            absl::StrCat("job '", id, "' waits for the next start of the server"));
      }
      changed_.wait(lock);  // another call has it, and cancels it or gives it back
    }
  }
  const JobSnapshot snapshot = job->snapshot();
  JobStateMachine draft(snapshot.info, snapshot.attempts, options_.clock);
  absl::Status status = draft.RequestCancel(now);
  if (status.ok()) status = journal_->Save(draft.snapshot().info, snapshot.attempts);
  if (status.ok()) {
    status = job->RequestCancel(now);
    Forget(*job);
  } else {
    std::lock_guard lock(mutex_);
    queue_.AddFirst(job, snapshot.info.client);
  }
  changed_.notify_all();
  return status;
}

absl::Status JobManager::Delete(const std::string& id, const std::string& project) {
  PLEAT_ASSIGN_OR_RETURN(const std::shared_ptr<JobStateMachine> job, Find(id, project));
  const JobInfo info = job->snapshot().info;
  if (!IsFinal(info.state)) {
    return absl::FailedPreconditionError(
        absl::StrCat("job '", id, "' is ", JobStateName(info.state),
                     "; only jobs that have ended are deleted, so cancel it first"));
  }
  // Nothing saves a job that was seen to have ended, so nothing brings it back.
  PLEAT_RETURN_IF_ERROR(journal_->Erase(info));
  Forget(*job);
  return absl::OkStatus();
}

void JobManager::Forget(const JobStateMachine& job) {
  std::lock_guard lock(mutex_);
  const auto registered = jobs_.find(job.id());
  if (registered == jobs_.end()) return;
  order_.erase(registered->second.number);
  jobs_.erase(registered);
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

JobManager::NextJob JobManager::FindNext() {
  NextJob next;
  if (runs_suspect_) return next;
  // Jobs of projects that wait are passed over, and the others go on.
  std::map<std::string, absl::Duration> waiting_times;
  next.job = queue_.Next([&](const JobStateMachine& job) {
    if (!options_.waiting_time) return true;
    const auto [it, is_new] = waiting_times.emplace(job.project(), absl::ZeroDuration());
    if (is_new) it->second = options_.waiting_time(job.project());
    if (it->second > absl::ZeroDuration()) next.wait = std::min(next.wait, it->second);
    return it->second <= absl::ZeroDuration();
  });
  // A suspect waits until it is alone, and nothing starts before it.
  if (next.job != nullptr && num_running_ > 0 && suspects_.contains(next.job->id())) return {};
  return next;
}

std::shared_ptr<JobStateMachine> JobManager::TakeNext() {
  std::unique_lock lock(mutex_);
  NextJob next;
  while (!shutting_down()) {
    next = FindNext();
    if (next.job != nullptr) break;
    if (next.wait == absl::InfiniteDuration()) {
      changed_.wait(lock);
    } else {
      changed_.wait_for(lock, absl::ToChronoNanoseconds(next.wait));
    }
  }
  if (shutting_down()) return nullptr;
  queue_.Take(next.job);
  // Here, so that a job that is off the queue and queued belongs to a call that cancels it.
  next.job->Start(options_.wall_clock());
  ++num_running_;
  runs_suspect_ = suspects_.erase(next.job->id()) > 0;
  return next.job;
}

void JobManager::Work() {
  if (options_.in_idle_time) RunInIdleTime();
  while (const std::shared_ptr<JobStateMachine> job = TakeNext()) {
    Save(job.get());
    RunOne(job.get());
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
  JobTime time(options_, job->project());
  const Progress progress(
      [job, &stages, &time](const ProgressUpdate& update) {
        stages.Enter(update.stage);
        time.Tell();
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
    job->Requeue();  // the server shuts down; the next process goes on
    Save(job);
  }
}

void JobManager::End(JobStateMachine* job, const EndJob& end) {
  const JobSnapshot snapshot = job->snapshot();
  JobStateMachine draft(snapshot.info, snapshot.attempts, options_.clock);
  if (!end(&draft)) return;
  if (SaveUntilDone(job, draft.snapshot())) {
    end(job);
    Forget(*job);
  } else {
    job->Requeue();  // the store still says that it runs, so the next process runs it again
  }
}

bool JobManager::SaveUntilDone(JobStateMachine* job, const JobSnapshot& ended) {
  for (bool is_first = true;; is_first = false) {
    const absl::Status status = journal_->Save(ended.info, ended.attempts);
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

bool JobManager::Save(JobStateMachine* job) {
  const JobSnapshot snapshot = job->snapshot();
  const absl::Status status = journal_->Save(snapshot.info, snapshot.attempts);
  if (!status.ok()) {
    job->AddWarning(absl::StrCat("the state of the job could not be saved: ",
                                 absl::string_view(status.message())));
  }
  return status.ok();
}

}  // namespace pleat
