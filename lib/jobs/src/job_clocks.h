// What is measured of a job while it runs.
#pragma once

#include <mutex>
#include <string>

#include "pleat/base/processor_time.h"
#include "pleat/jobs/job_manager.h"

namespace pleat {

// How long a job is in each of its stages.
class StageClock {
 public:
  explicit StageClock(const JobManagerOptions& options) : options_(options) {}
  ~StageClock() { Enter(""); }

  void Enter(const std::string& stage) {
    if (!options_.on_stage) return;
    std::lock_guard lock(mutex_);
    if (stage == stage_) return;
    const double now = options_.clock();
    if (!stage_.empty()) options_.on_stage(stage_, now - since_);
    stage_ = stage;
    since_ = now;
  }

 private:
  const JobManagerOptions& options_;
  std::mutex mutex_;
  std::string stage_;  // guarded by mutex_, as is the next; empty before the first
  double since_ = 0;
};

// The processor time of one job, from its thread and those that it makes.
class JobTime {
 public:
  JobTime(const JobManagerOptions& options, const std::string& project)
      : options_(options), project_(project) {}
  ~JobTime() { Tell(); }

  void Tell() {
    if (!options_.on_processor_time) return;
    scope_.Update();
    std::lock_guard lock(mutex_);
    const double used = meter_.seconds();
    if (used > told_) options_.on_processor_time(project_, used - told_);
    told_ = used;
  }

 private:
  const JobManagerOptions& options_;
  const std::string project_;
  ProcessorTimeMeter meter_;
  ProcessorTimeMeter::Scope scope_{&meter_};
  std::mutex mutex_;
  double told_ = 0;  // guarded by mutex_
};

}  // namespace pleat
