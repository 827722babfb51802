// How many frames a project may ask for.
#pragma once

#include <cstdint>
#include <mutex>
#include <string>

#include "absl/status/status.h"
#include "pleat/jobs/job_state_machine.h"

namespace pleat {

// A token bucket that may go into debt: a request is let in while anything is left, and is then
// charged as a whole. So a clip is never cut, however long, and the project waits afterwards until
// its frames are paid for. Thread-safe.
class FrameQuota {
 public:
  // frames_per_second: 0 = no limit. What was not used is kept for kBurstSeconds.
  FrameQuota(double frames_per_second, std::string project, MonotonicClock clock = SteadySeconds);
  FrameQuota(const FrameQuota&) = delete;
  FrameQuota& operator=(const FrameQuota&) = delete;

  static constexpr double kBurstSeconds = 2;

  // kResourceExhausted, with the time after which there will be something left.
  absl::Status Take(int64_t num_frames);

 private:
  const double frames_per_second_;
  const std::string project_;
  const MonotonicClock clock_;
  std::mutex mutex_;
  double left_ = 0;       // negative: debt; guarded by mutex_
  double filled_at_ = 0;  // guarded by mutex_
};

}  // namespace pleat
