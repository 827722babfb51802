#include "pleat/local/project_quota.h"

#include <algorithm>
#include <utility>

#include "absl/strings/str_cat.h"
#include "pleat/base/limit_refusal.h"

namespace pleat {
namespace {

constexpr double kFrameBurstSeconds = 2;
constexpr double kHour = 3600;
constexpr double kUnit = 1;  // less than this is nothing left

}  // namespace

ProjectQuotaOptions ProjectQuota::OfFrames(const std::string& project, double frames_per_second) {
  return {.project = project,
          .per_second = frames_per_second,
          .burst_seconds = kFrameBurstSeconds,
          .flag = "--project-frames-per-second",
          .what = absl::StrCat(frames_per_second, " frames per second")};
}

ProjectQuotaOptions ProjectQuota::OfJobTime(const std::string& project, double seconds_per_hour) {
  return {.project = project,
          .per_second = seconds_per_hour / kHour,
          .burst_seconds = kHour,
          .flag = "--project-job-cpu-seconds-per-hour",
          .what = absl::StrCat(seconds_per_hour, " seconds of processor time for jobs per hour")};
}

ProjectQuota::ProjectQuota(ProjectQuotaOptions options, MonotonicClock clock)
    : options_(std::move(options)),
      clock_(std::move(clock)),
      left_(std::max(kUnit, options_.per_second * options_.burst_seconds)),
      filled_at_(clock_()) {}

void ProjectQuota::Refill() {
  const double now = clock_();
  const double most = std::max(kUnit, options_.per_second * options_.burst_seconds);
  left_ = std::min(most, left_ + (now - filled_at_) * options_.per_second);
  filled_at_ = now;
}

absl::Duration ProjectQuota::WaitingTime() const {
  if (options_.per_second <= 0 || left_ >= kUnit) return absl::ZeroDuration();
  return absl::Ceil(absl::Seconds((kUnit - left_) / options_.per_second), absl::Milliseconds(1));
}

absl::Status ProjectQuota::Take(double amount) {
  std::lock_guard lock(mutex_);
  Refill();
  const absl::Duration wait = WaitingTime();
  if (wait == absl::ZeroDuration()) {
    left_ -= amount;
    used_ += amount;
    return absl::OkStatus();
  }
  return RefuseForLimit({.subject = absl::StrCat("project:", options_.project),
                         .limit = options_.flag,
                         .retry_after = wait},
                        absl::StrCat("the project '", options_.project, "' has used more than ",
                                     options_.what, " (", options_.flag, ")"));
}

void ProjectQuota::Charge(double amount) {
  std::lock_guard lock(mutex_);
  Refill();
  left_ -= amount;
  used_ += amount;
}

absl::Duration ProjectQuota::TimeUntilFree() {
  std::lock_guard lock(mutex_);
  Refill();
  return WaitingTime();
}

double ProjectQuota::used() const {
  std::lock_guard lock(mutex_);
  return used_;
}

}  // namespace pleat
