#include "pleat/local/frame_quota.h"

#include <algorithm>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/time/time.h"
#include "pleat/base/limit_refusal.h"

namespace pleat {

FrameQuota::FrameQuota(double frames_per_second, std::string project, MonotonicClock clock)
    : frames_per_second_(frames_per_second),
      project_(std::move(project)),
      clock_(std::move(clock)),
      left_(frames_per_second * kBurstSeconds),
      filled_at_(clock_()) {}

absl::Status FrameQuota::Take(int64_t num_frames) {
  if (frames_per_second_ <= 0) return absl::OkStatus();
  const double now = clock_();
  std::lock_guard lock(mutex_);
  left_ =
      std::min(frames_per_second_ * kBurstSeconds, left_ + (now - filled_at_) * frames_per_second_);
  filled_at_ = now;
  if (left_ >= 1) {
    left_ -= static_cast<double>(num_frames);
    return absl::OkStatus();
  }
  const absl::Duration wait = absl::Seconds((1 - left_) / frames_per_second_);
  return RefuseForLimit(
      {.subject = absl::StrCat("project:", project_),
       .limit = "--project-frames-per-second",
       .retry_after = absl::Ceil(wait, absl::Milliseconds(1))},
      absl::StrCat("the project '", project_, "' has asked for more than ", frames_per_second_,
                   " frames per second (--project-frames-per-second)"));
}

}  // namespace pleat
