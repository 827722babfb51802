#include "pleat/service/job_service.h"

#include <chrono>
#include <condition_variable>
#include <mutex>

#include "pleat/base/status.h"

namespace pleat {
namespace {

// How often an observer is asked without news, so that one who wants to stop is heard.
constexpr auto kHeartbeat = std::chrono::milliseconds(250);

// Rung by the listener, which may outlive the watch by a moment.
struct Bell {
  std::mutex mutex;
  std::condition_variable changed;
  bool rung = false;

  void Ring() {
    std::lock_guard lock(mutex);
    rung = true;
    changed.notify_all();
  }
  void Wait() {
    std::unique_lock lock(mutex);
    changed.wait_for(lock, kHeartbeat, [this] { return rung; });
    rung = false;
  }
};

}  // namespace

bool IsFinal(JobState state) {
  return state == JobState::kSucceeded || state == JobState::kFailed ||
         state == JobState::kCancelled;
}

const char* JobStateName(JobState state) {
  switch (state) {
    case JobState::kQueued:
      return "queued";
    case JobState::kRunning:
      return "running";
    case JobState::kSucceeded:
      return "succeeded";
    case JobState::kFailed:
      return "failed";
    case JobState::kCancelled:
      return "cancelled";
  }
  return "unknown";
}

absl::Status WatchJob(JobService& jobs, const std::string& id,
                      const std::function<bool(const JobInfo&)>& observe) {
  const auto bell = std::make_shared<Bell>();
  PLEAT_ASSIGN_OR_RETURN(const std::unique_ptr<JobSubscription> subscription,
                         jobs.Subscribe(id, [bell] { bell->Ring(); }));
  JobUpdate seen = subscription->current();
  if (!observe(seen.info)) return absl::OkStatus();
  while (!IsFinal(seen.info.state)) {
    bell->Wait();
    // The status first: what happened before it ended is then in the update.
    const absl::Status status = subscription->status();
    JobUpdate next = subscription->current();
    if (next.revision == seen.revision) PLEAT_RETURN_IF_ERROR(status);
    seen = std::move(next);
    if (!observe(seen.info)) return absl::OkStatus();
  }
  return absl::OkStatus();
}

}  // namespace pleat
