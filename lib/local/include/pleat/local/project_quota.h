// How much a project may use of something per time: frames, or the processor time of its jobs.
#pragma once

#include <mutex>
#include <string>

#include "absl/status/status.h"
#include "absl/time/time.h"
#include "pleat/jobs/job_state_machine.h"

namespace pleat {

struct ProjectQuotaOptions {
  std::string project{};
  double per_second = 0;     // 0: no limit
  double burst_seconds = 0;  // for so long what was not used is kept
  std::string flag{};        // that sets it: "--project-frames-per-second"
  std::string what{};        // in words, with the number: "30 frames per second"
};

// A token bucket that may go into debt: a request is let in while a unit is left, and is then
// charged as a whole. So a clip or a job is never cut, however long, and the project waits
// afterwards until it is paid for. Thread-safe.
class ProjectQuota {
 public:
  explicit ProjectQuota(ProjectQuotaOptions options, MonotonicClock clock = SteadySeconds);
  ProjectQuota(const ProjectQuota&) = delete;
  ProjectQuota& operator=(const ProjectQuota&) = delete;

  // Frames that are evaluated or decoded; 0: no limit.
  static ProjectQuotaOptions OfFrames(const std::string& project, double frames_per_second);
  // Processor time of jobs; 0: no limit. A whole hour's share can be used at once.
  static ProjectQuotaOptions OfJobTime(const std::string& project, double seconds_per_hour);

  // kResourceExhausted, with the time after which there will be something left. Else charges it.
  absl::Status Take(double amount);
  // Charges what was used without a question.
  void Charge(double amount);
  // How long it will take until a unit is left; zero: there is one.
  absl::Duration TimeUntilFree();
  // All that was ever charged.
  double used() const;

 private:
  void Refill();  // with mutex_ held
  absl::Duration WaitingTime() const;

  const ProjectQuotaOptions options_;
  const MonotonicClock clock_;
  mutable std::mutex mutex_;
  double left_ = 0;       // negative: debt; guarded by mutex_, as is all below
  double filled_at_ = 0;  // seconds
  double used_ = 0;
};

}  // namespace pleat
