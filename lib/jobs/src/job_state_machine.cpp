#include "pleat/jobs/job_state_machine.h"

#include <algorithm>
#include <chrono>
#include <utility>

#include "absl/strings/str_cat.h"

namespace pleat {
namespace {

// Before this, elapsed / fraction says little about the end.
constexpr double kMinSecondsForEta = 1;
constexpr double kMinFractionForEta = .02;

}  // namespace

double SteadySeconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

JobStateMachine::JobStateMachine(JobInfo info, int attempts, MonotonicClock clock)
    : clock_(std::move(clock)) {
  state_.info = std::move(info);
  state_.attempts = attempts;
}

JobSnapshot JobStateMachine::snapshot() const {
  std::lock_guard lock(mutex_);
  return SnapshotNow();
}

JobSnapshot JobStateMachine::SnapshotNow() const {
  JobSnapshot now = state_;
  if (now.info.eta_seconds) {
    now.info.eta_seconds =
        std::max(0.0, *now.info.eta_seconds - std::max(0.0, clock_() - reported_seconds_));
  }
  return now;
}

JobState JobStateMachine::state() const {
  std::lock_guard lock(mutex_);
  return state_.info.state;
}

bool JobStateMachine::Start(absl::Time now) {
  {
    std::lock_guard lock(mutex_);
    if (state_.info.state != JobState::kQueued) return false;
    state_.info.state = JobState::kRunning;
    state_.info.stage = "start";
    ++state_.attempts;
    ++state_.revision;
    state_.info.started = now;
    started_seconds_ = clock_();
  }
  Changed();
  return true;
}

void JobStateMachine::Report(const ProgressUpdate& update) {
  {
    std::lock_guard lock(mutex_);
    if (state_.info.state != JobState::kRunning) return;
    JobInfo& info = state_.info;
    info.stage = update.stage;
    info.fraction = std::max(info.fraction, std::clamp(update.fraction, 0.0, 1.0));
    info.objective = update.objective;
    reported_seconds_ = clock_();
    const double elapsed = reported_seconds_ - started_seconds_;
    if (elapsed >= kMinSecondsForEta && info.fraction >= kMinFractionForEta) {
      info.eta_seconds = elapsed * (1 - info.fraction) / info.fraction;
    }
    ++state_.revision;
  }
  Changed();
}

bool JobStateMachine::Succeed(const std::string& result_id,
                              const std::vector<std::string>& warnings, absl::Time now) {
  {
    std::lock_guard lock(mutex_);
    if (state_.info.state != JobState::kRunning) return false;
    state_.info.result_id = result_id;
    state_.info.fraction = 1;
    state_.info.warnings.insert(state_.info.warnings.end(), warnings.begin(), warnings.end());
  }
  return Finish(JobState::kSucceeded, absl::OkStatus(), now);
}

bool JobStateMachine::Fail(const absl::Status& error, absl::Time now) {
  return Finish(JobState::kFailed, error, now);
}

bool JobStateMachine::Cancelled(absl::Time now) {
  return Finish(JobState::kCancelled, absl::CancelledError("the job was cancelled"), now);
}

bool JobStateMachine::Finish(JobState state, const absl::Status& error, absl::Time now) {
  {
    std::lock_guard lock(mutex_);
    if (state_.info.state != JobState::kRunning) return false;
    state_.info.state = state;
    state_.info.error = error;
    state_.info.ended = now;
    state_.info.eta_seconds.reset();
    ++state_.revision;
  }
  Changed();
  return true;
}

bool JobStateMachine::Requeue() {
  {
    std::lock_guard lock(mutex_);
    if (state_.info.state != JobState::kRunning) return false;
    state_.info.state = JobState::kQueued;
    state_.info.stage.clear();
    state_.info.started.reset();
    state_.info.fraction = 0;
    state_.info.objective.reset();
    state_.info.eta_seconds.reset();
    --state_.attempts;
    ++state_.revision;
  }
  Changed();
  return true;
}

absl::Status JobStateMachine::RequestCancel(absl::Time now) {
  {
    std::lock_guard lock(mutex_);
    JobInfo& info = state_.info;
    if (IsFinal(info.state)) {
      return absl::FailedPreconditionError(
          absl::StrCat("job '", info.id, "' is already over: ", JobStateName(info.state)));
    }
    cancel_requested_.store(true, std::memory_order_relaxed);
    if (info.state != JobState::kQueued) return absl::OkStatus();
    info.state = JobState::kCancelled;
    info.error = absl::CancelledError("the job was cancelled before it started");
    info.ended = now;
    ++state_.revision;
  }
  Changed();
  return absl::OkStatus();
}

void JobStateMachine::AddWarning(const std::string& warning) {
  {
    std::lock_guard lock(mutex_);
    state_.info.warnings.push_back(warning);
    ++state_.revision;
  }
  Changed();
}

JobSnapshot JobStateMachine::WaitForChange(uint64_t revision, double timeout_seconds) const {
  std::unique_lock lock(mutex_);
  changed_.wait_for(lock, std::chrono::duration<double>(timeout_seconds),
                    [&] { return state_.revision > revision; });
  return SnapshotNow();
}

int JobStateMachine::AddListener(std::function<void()> listener) {
  std::lock_guard lock(listeners_mutex_);
  listeners_.emplace(next_token_, std::move(listener));
  return next_token_++;
}

void JobStateMachine::RemoveListener(int token) {
  std::lock_guard lock(listeners_mutex_);
  listeners_.erase(token);
}

void JobStateMachine::Wake() { Changed(); }

void JobStateMachine::Changed() {
  changed_.notify_all();
  std::lock_guard lock(listeners_mutex_);
  for (const auto& [token, listener] : listeners_) listener();
}

}  // namespace pleat
