#include <chrono>
#include <future>
#include <map>
#include <mutex>

#include "absl/strings/str_cat.h"
#include "cli/interrupt.h"
#include "cli/service.h"
#include "cli/show/progress_display.h"
#include "pleat/base/status.h"

namespace pleat {
namespace {

constexpr auto kInterruptInterval = std::chrono::milliseconds(50);

// What the watching thread saw last. The main thread is the one that looks at Ctrl-C, so the job is
// watched on a thread of its own.
struct Watched {
  std::mutex mutex;
  JobInfo job;
};

// Returns how a job has ended, or why that is not known.
absl::Status EndOf(const absl::Status& watch, const JobInfo& job) {
  if (absl::IsUnavailable(watch)) {
    return absl::UnavailableError(absl::StrCat(watch.message(), "; job ", job.id,
                                               " may go on: see 'pleat jobs show ", job.id, "'"));
  }
  PLEAT_RETURN_IF_ERROR(watch);
  if (job.state == JobState::kCancelled) {
    return absl::CancelledError(absl::StrCat("job ", job.id, " was cancelled"));
  }
  if (job.state == JobState::kFailed) {
    return absl::Status(job.error.ok() ? absl::StatusCode::kInternal : job.error.code(),
                        absl::StrCat("job ", job.id, " failed: ", job.error.message()));
  }
  return absl::OkStatus();
}

}  // namespace

absl::StatusOr<JobInfo> WatchJobToEnd(JobService& jobs, const std::string& id,
                                      const Session& session, bool cancel_on_interrupt,
                                      std::map<std::string, double>* stage_seconds) {
  ProgressDisplay display(*session.err, ChooseProgressStyle(session), MonotonicSeconds);
  Watched watched;
  watched.job.id = id;
  std::future<absl::Status> watching = std::async(std::launch::async, [&] {
    return WatchJob(jobs, id, [&](const JobInfo& job) {
      if (job.state == JobState::kRunning || job.state == JobState::kSucceeded) {
        const bool done = job.state == JobState::kSucceeded;
        display.Update({done ? "done" : job.stage, done ? 1.0 : job.fraction, job.objective},
                       job.eta_seconds);
      } else if (job.state == JobState::kQueued) {
        display.Update({"queued", 0, std::nullopt});
      }
      std::lock_guard lock(watched.mutex);
      watched.job = job;
      return true;
    });
  });
  bool cancelled = false;
  while (watching.wait_for(kInterruptInterval) != std::future_status::ready) {
    if (!cancel_on_interrupt || cancelled || !Interrupted()) continue;
    cancelled = true;
    // The watch ends by itself when the job is cancelled. When it cannot be cancelled, the error
    // says why.
    if (absl::Status status = jobs.Cancel(id); !status.ok()) {
      *session.err << "cannot cancel job " << id << ": " << status.message() << std::endl;
    }
  }
  display.Finish();
  if (stage_seconds != nullptr) *stage_seconds = display.stage_seconds();
  PLEAT_RETURN_IF_ERROR(EndOf(watching.get(), watched.job));
  return watched.job;
}

}  // namespace pleat
