// The state of one job, in one thread-safe place.
//
//   queued --Start--> running --Succeed--> succeeded
//     |  ^               |------Fail-----> failed
//     |  '---Requeue-----|
//     |                  '--Cancelled----> cancelled   (after RequestCancel, when the worker stops)
//     '------------------RequestCancel---> cancelled   (at once)
//
// succeeded, failed and cancelled are final.
#pragma once

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <map>
#include <mutex>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/time/time.h"
#include "pleat/base/progress.h"
#include "pleat/service/job_service.h"

namespace pleat {

// Seconds of a clock that never goes back.
using MonotonicClock = std::function<double()>;
double SteadySeconds();

struct JobSnapshot {
  JobInfo info;
  int attempts = 0;       // how often the job was started
  uint64_t revision = 0;  // grows with every change
};

class JobStateMachine {
 public:
  JobStateMachine(JobInfo info, int attempts, MonotonicClock clock = SteadySeconds);
  JobStateMachine(const JobStateMachine&) = delete;
  JobStateMachine& operator=(const JobStateMachine&) = delete;

  JobSnapshot snapshot() const;
  JobState state() const;
  // Neither ever changes.
  const std::string& id() const { return state_.info.id; }
  const std::string& project() const { return state_.info.project; }

  // Each returns false, and does nothing, when the job is not in the state that it starts from.
  // now: the time of day, which the job keeps as that of its start or end.
  bool Start(absl::Time now);
  void Report(const ProgressUpdate& update);  // ignored unless running; fractions never fall
  bool Succeed(const std::string& result_id, const std::vector<std::string>& warnings,
               absl::Time now);
  bool Fail(const absl::Status& error, absl::Time now);
  bool Cancelled(absl::Time now);
  bool Requeue();  // the attempt that ends here does not count

  // A queued job is cancelled, a running one asked to stop (cancel_requested). kFailedPrecondition
  // when the job is final.
  absl::Status RequestCancel(absl::Time now);
  bool cancel_requested() const { return cancel_requested_.load(std::memory_order_relaxed); }

  void AddWarning(const std::string& warning);

  // Waits until the revision is above `revision` or `timeout_seconds` are over.
  JobSnapshot WaitForChange(uint64_t revision, double timeout_seconds) const;

  // Calls `listener` after every change, until RemoveListener. The listener must be quick and must
  // not call this object; RemoveListener returns only when no call is running.
  int AddListener(std::function<void()> listener);
  void RemoveListener(int token);
  void Wake();  // calls the listeners although nothing has changed

 private:
  // The state with the estimate counted down since the last report. Call it with mutex_ held.
  JobSnapshot SnapshotNow() const;
  bool Finish(JobState state, const absl::Status& error, absl::Time now);
  void Changed();

  const MonotonicClock clock_;
  std::atomic<bool> cancel_requested_ = false;

  mutable std::mutex mutex_;
  mutable std::condition_variable changed_;
  JobSnapshot state_;                                  // guarded by mutex_
  double started_seconds_ = 0, reported_seconds_ = 0;  // guarded by mutex_

  std::mutex listeners_mutex_;
  std::map<int, std::function<void()>> listeners_;  // guarded by listeners_mutex_
  int next_token_ = 1;                              // guarded by listeners_mutex_
};

}  // namespace pleat
