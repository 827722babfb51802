// Queue and worker pool of jobs.
#pragma once

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "pleat/base/wall_clock.h"
#include "pleat/jobs/job_queue.h"
#include "pleat/jobs/job_state_machine.h"

namespace pleat {

struct JobOutcome {
  std::string result_id;  // of the model or of the compressed sequence
  std::vector<std::string> warnings;
};

// Does the work of one job: reports to and obeys the token.
using RunJob = std::function<absl::StatusOr<JobOutcome>(const JobInfo&, const Progress&)>;
// Writes the job down, durably; called at every change of state.
using SaveJob = std::function<absl::Status(const JobInfo& info, int attempts)>;
// Removes what SaveJob wrote, durably.
using EraseJob = std::function<absl::Status(const JobInfo& info)>;
inline absl::Status EraseNothing(const JobInfo&) { return absl::OkStatus(); }

struct JobManagerOptions {
  int num_workers = 1;              // jobs that run at the same time
  int max_queued = 1000;            // jobs that wait; more are refused
  int max_queued_per_client = 250;  // the same for one client; jobs without a client share this too
  int max_queued_per_project = 0;   // the same for all clients of a project; 0: no limit
  int max_attempts = 3;             // a job that took the server down this often fails
  double save_retry_seconds = 1;    // between two tries to save how a job ended
  // The threads of jobs run in the processor time that nothing else wants, so that live sessions in
  // the same process keep their pace.
  bool in_idle_time = false;
  // Hears how long a job was in a stage, when it leaves it, from any thread. May be empty.
  std::function<void(const std::string& stage, double seconds)> on_stage{};
  MonotonicClock clock = SteadySeconds;
  WallClock wall_clock = SystemTime;  // for the times that jobs keep
};

struct StoredJob {
  JobInfo info;
  int attempts = 0;
};

// Jobs start in the order of Create.
//
// Nobody sees that a job has ended before that is saved: until then it is running, and its worker
// tries to save it again and again. So what was seen final is final after a restart too.
//
// When the process dies, the jobs that were running are suspects, and only one of them is to blame.
// A suspect runs alone the next time: none other starts beside it. If the process dies again, the
// attempt counts against the job that ran alone, and against no job that ran beside others.
//
// Thread-safe.
class JobManager {
 public:
  // erase: for a manager whose jobs are written down somewhere.
  JobManager(JobManagerOptions options, RunJob run, SaveJob save, EraseJob erase = EraseNothing);
  ~JobManager();  // Shutdown
  JobManager(const JobManager&) = delete;
  JobManager& operator=(const JobManager&) = delete;

  // Takes over the jobs of the process before, in their order: a job that was running is queued
  // again, or failed when it has taken the process down max_attempts times. Call before Start.
  void Restore(std::vector<StoredJob> jobs);
  void Start();

  // Gives the job an id and queues it. A draft with the request_id of an earlier job of the same
  // project makes none: the earlier one is returned, or kAlreadyExists when it works on something
  // else. kResourceExhausted when too many wait, kUnavailable after Shutdown, or the error of
  // saving it.
  absl::StatusOr<JobInfo> Create(JobInfo draft);
  absl::StatusOr<JobInfo> Get(const std::string& id) const;  // or kNotFound
  std::vector<JobInfo> List() const;                         // oldest first
  size_t CountInState(JobState state) const;
  // Shows every job in the order of creation. `visit` must be quick and must not call this object.
  void Visit(const std::function<void(const JobInfo&)>& visit) const;
  // kNotFound, kFailedPrecondition when the job has ended, or the error of saving it.
  absl::Status Cancel(const std::string& id);
  // Forgets a job that has ended. kNotFound, kFailedPrecondition when it has not ended, or the
  // error of removing what was saved: then the job stays.
  absl::Status Delete(const std::string& id);
  absl::StatusOr<std::shared_ptr<JobStateMachine>> Find(const std::string& id) const;

  // Stops the workers; what was running is queued again, for the next process. Returns when the
  // workers have ended, that is within a second.
  void Shutdown();
  bool shutting_down() const { return shutting_down_.load(std::memory_order_relaxed); }

 private:
  using EndJob = std::function<bool(JobStateMachine*)>;

  void RestoreRunning(JobSnapshot snapshot, bool ran_alone);
  void Work();
  std::shared_ptr<JobStateMachine> TakeNext();  // null at shutdown
  bool MayStartNext() const;                    // call with mutex_ held
  void RunOne(JobStateMachine* job);
  // Saves the state that `end` will bring the job to, and then brings it there.
  void End(JobStateMachine* job, const EndJob& end);
  bool SaveUntilDone(JobStateMachine* job, const JobSnapshot& ended);  // false at shutdown
  void Save(JobStateMachine* job);
  void SaveUnlessDeleted(JobStateMachine* job);

  const JobManagerOptions options_;
  const RunJob run_;
  const SaveJob save_;
  const EraseJob erase_;
  std::atomic<bool> shutting_down_ = false;

  // Taken before mutex_ and held while a new job is saved: one after the other, so the order in the
  // store is the order in the queue.
  std::mutex create_mutex_;
  // Taken before mutex_ and held while a job is erased, or a job that was seen to have ended is
  // saved: so that no save brings back what was erased.
  std::mutex erase_mutex_;
  mutable std::mutex mutex_;         // never held while a job is saved
  std::condition_variable changed_;  // a worker may have something to do
  std::condition_variable stopped_;  // shutting_down_
  // Returns the job of `draft.request_id`, null when there is none. Call with mutex_ held.
  absl::StatusOr<std::shared_ptr<JobStateMachine>> FindRequest(const JobInfo& draft) const;
  // Why the queue has no place for the job. Call with mutex_ held.
  absl::Status CheckQueue(const JobInfo& draft) const;
  // Makes the job known, and lets it wait if it is queued. Call with mutex_ held.
  void Register(std::shared_ptr<JobStateMachine> job);

  struct Registered {
    std::shared_ptr<JobStateMachine> job;
    uint64_t number = 0;  // in the order of creation
  };
  std::map<std::string, Registered> jobs_;             // by id; guarded by mutex_
  std::map<std::string, std::string> ids_by_request_;  // by RequestKey; guarded by mutex_
  std::map<uint64_t, std::string> order_;              // ids by number; guarded by mutex_
  uint64_t next_number_ = 0;                           // guarded by mutex_
  JobQueue queue_;                                     // guarded by mutex_
  std::set<std::string> suspects_;  // ids of jobs that run alone; guarded by mutex_
  int num_running_ = 0;             // guarded by mutex_
  bool runs_suspect_ = false;       // guarded by mutex_
  std::vector<std::thread> workers_;
};

}  // namespace pleat
