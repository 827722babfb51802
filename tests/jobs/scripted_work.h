// Work for job managers, and a journal that may fail.
#pragma once

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <map>
#include <mutex>
#include <string>
#include <vector>

#include "pleat/jobs/job_manager.h"

namespace pleat {

// A journal in memory that remembers the newest save of every job, and may fail.
class Journal : public JobJournal {
 public:
  absl::Status Save(const JobInfo& info, int attempts) override {
    std::lock_guard lock(mutex_);
    if (fail_) return absl::ResourceExhaustedError("disk full");
    if (!saved_.contains(info.id)) order_.push_back(info.id);
    saved_[info.id] = {info, attempts};
    return absl::OkStatus();
  }
  absl::Status Erase(const JobInfo& info) override {
    std::lock_guard lock(mutex_);
    if (fail_) return absl::ResourceExhaustedError("disk full");
    saved_.erase(info.id);
    return absl::OkStatus();
  }
  absl::StatusOr<StoredJob> Read(const std::string& project, const std::string& id) override {
    std::lock_guard lock(mutex_);
    ++num_reads_;
    const auto it = saved_.find(id);
    if (it != saved_.end() && it->second.info.project == project) return it->second;
    return absl::NotFoundError("no job '" + id + "'");
  }
  absl::StatusOr<StoredJob> FindRequest(const std::string& project,
                                        const std::string& request_id) override {
    std::lock_guard lock(mutex_);
    for (const auto& [id, job] : saved_) {
      if (job.info.project == project && job.info.request_id == request_id) return job;
    }
    return absl::NotFoundError("no such request");
  }
  StoredJob at(const std::string& id) {
    std::lock_guard lock(mutex_);
    return saved_.at(id);
  }
  void Fail(bool fail) {
    std::lock_guard lock(mutex_);
    fail_ = fail;
  }
  size_t size() {
    std::lock_guard lock(mutex_);
    return saved_.size();
  }
  int num_reads() {
    std::lock_guard lock(mutex_);
    return num_reads_;
  }
  // The names of the saved jobs, in the order of their first save.
  std::vector<std::string> names() {
    std::lock_guard lock(mutex_);
    std::vector<std::string> names;
    for (const std::string& id : order_) {
      if (saved_.contains(id)) names.push_back(saved_[id].info.name);
    }
    return names;
  }

 private:
  std::mutex mutex_;
  std::map<std::string, StoredJob> saved_;  // by id; guarded by mutex_, as is all below
  std::vector<std::string> order_;
  bool fail_ = false;
  int num_reads_ = 0;
};

inline JobInfo WaitForEnd(JobManager& jobs, const std::string& id) {
  const auto job = jobs.Find(id).value();
  JobSnapshot snapshot = job->snapshot();
  const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(10);
  while (!IsFinal(snapshot.info.state) && std::chrono::steady_clock::now() < deadline) {
    snapshot = job->WaitForChange(snapshot.revision, .2);
  }
  return snapshot.info;
}

inline RunJob Succeeds() {
  return [](const JobInfo& info, const Progress& progress) -> absl::StatusOr<JobOutcome> {
    if (absl::Status status = progress.Report(.5); !status.ok()) return status;
    return JobOutcome{"model of " + info.name, {"careful"}};
  };
}

// How many jobs run now and have run at most, and a wait for them.
class Running {
 public:
  void Enter() {
    std::lock_guard lock(mutex_);
    ++now_;
    ++entered_;
    most_ = std::max(most_, now_);
    changed_.notify_all();
  }
  void Leave() {
    std::lock_guard lock(mutex_);
    --now_;
  }
  // Until `count` jobs have begun; false when that takes so long that they never will.
  bool WaitForEntered(int count) {
    std::unique_lock lock(mutex_);
    return changed_.wait_for(lock, std::chrono::seconds(30), [&] { return entered_ >= count; });
  }
  // A moment in which nothing is decided, between two looks at a flag that cannot notify.
  void Pause() {
    std::unique_lock lock(mutex_);
    changed_.wait_for(lock, std::chrono::milliseconds(1));
  }
  int most() {
    std::lock_guard lock(mutex_);
    return most_;
  }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  int now_ = 0, entered_ = 0, most_ = 0;
};

// Runs until it is cancelled.
inline RunJob NeverEnds(Running* running) {
  return [running](const JobInfo&, const Progress& progress) -> absl::StatusOr<JobOutcome> {
    running->Enter();
    while (!progress.cancelled()) running->Pause();
    running->Leave();
    return absl::CancelledError("stopped");
  };
}

inline JobInfo Named(const std::string& name) {
  JobInfo info;
  info.name = name;
  return info;
}

}  // namespace pleat
