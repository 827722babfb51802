// A job that goes through the states it is told.
#pragma once

#include <algorithm>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "pleat/service/job_service.h"

namespace pleat {

// Every look at the job shows its next state, and the listener says that there is more. When the
// last state is not final, the subscription ends after it with `end`.
class ScriptedSubscription final : public JobSubscription {
 public:
  ScriptedSubscription(std::vector<JobInfo> script, absl::Status end,
                       std::function<void()> listener)
      : script_(std::move(script)), end_(std::move(end)), listener_(std::move(listener)) {}

  JobUpdate current() const override {
    size_t index = 0;
    {
      std::lock_guard lock(mutex_);
      index = std::min(next_, script_.size() - 1);
      ++next_;
    }
    listener_();
    return {script_[index], index + 1};
  }
  absl::Status status() const override {
    std::lock_guard lock(mutex_);
    return next_ < script_.size() ? absl::OkStatus() : end_;
  }

 private:
  const std::vector<JobInfo> script_;
  const absl::Status end_;
  const std::function<void()> listener_;
  mutable std::mutex mutex_;
  mutable size_t next_ = 0;  // guarded by mutex_
};

}  // namespace pleat
