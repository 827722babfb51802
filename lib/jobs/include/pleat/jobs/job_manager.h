// Queue and worker pool of jobs.
#pragma once

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "pleat/base/wall_clock.h"
#include "pleat/jobs/job_journal.h"
#include "pleat/jobs/job_queue.h"
#include "pleat/jobs/job_state_machine.h"

namespace pleat {

struct JobOutcome {
  std::string result_id;  // of the model or of the compressed sequence
  std::vector<std::string> warnings;
};

// Does the work of one job: reports to and obeys the token.
using RunJob = std::function<absl::StatusOr<JobOutcome>(const JobInfo&, const Progress&)>;

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
  // Hears how much processor time a job has used since it heard of it last, from the thread of the
  // job: with each report and at its end. May be empty.
  std::function<void(const std::string& project, double seconds)> on_processor_time{};
  // How long the jobs of a project must wait before the next one starts; zero: not at all. Asked
  // with a lock of this object held. Empty: no project waits.
  std::function<absl::Duration(const std::string& project)> waiting_time{};
  MonotonicClock clock = SteadySeconds;
  WallClock wall_clock = SystemTime;  // for the times that jobs keep
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
// In memory are the jobs that have not ended, and those that somebody holds. What has ended is in
// the journal alone, so that neither memory nor a start depends on how many jobs have ended.
//
// Thread-safe.
class JobManager {
 public:
  // The journal must outlive the manager.
  JobManager(JobManagerOptions options, RunJob run, JobJournal* journal);
  ~JobManager();  // Shutdown
  JobManager(const JobManager&) = delete;
  JobManager& operator=(const JobManager&) = delete;

  // Takes over the jobs of the process before that have not ended, in their order: a job that was
  // running is queued again, or failed when it has taken the process down max_attempts times. Call
  // before Start.
  void Restore(std::vector<StoredJob> jobs);
  void Start();

  // Gives the job an id and queues it. A draft with the request_id of an earlier job of the same
  // project makes none: the earlier one is returned, or kAlreadyExists when it works on something
  // else. kResourceExhausted when too many wait, kUnavailable after Shutdown, or the error of
  // saving it.
  absl::StatusOr<JobInfo> Create(JobInfo draft);
  // The jobs that have not ended, oldest first.
  std::vector<JobInfo> ListUnfinished() const;

  // The calls below are about a job of the project, and are kNotFound when it has no such job.
  //
  // Returns the job, wherever it is. One that has ended never changes again.
  absl::StatusOr<std::shared_ptr<JobStateMachine>> Find(
      const std::string& id, const std::string& project = kDefaultProject) const;
  absl::StatusOr<JobInfo> Get(const std::string& id,
                              const std::string& project = kDefaultProject) const;
  // kFailedPrecondition when the job has ended, kUnavailable when a shutdown has taken it off its
  // worker, or the error of saving it.
  absl::Status Cancel(const std::string& id, const std::string& project = kDefaultProject);
  // Forgets a job that has ended. kFailedPrecondition when it has not ended, or the error of
  // removing what was saved: then the job stays.
  absl::Status Delete(const std::string& id, const std::string& project = kDefaultProject);

  // Stops the workers; what was running is queued again, for the next process. Returns when the
  // workers have ended, that is within a second.
  void Shutdown();
  bool shutting_down() const { return shutting_down_.load(std::memory_order_relaxed); }

 private:
  using EndJob = std::function<bool(JobStateMachine*)>;

  // The job if it is in memory, else null.
  std::shared_ptr<JobStateMachine> FindUnfinished(const std::string& id,
                                                  const std::string& project) const;
  void RestoreRunning(JobSnapshot snapshot, bool ran_alone);
  void Work();
  std::shared_ptr<JobStateMachine> TakeNext();  // starts it; null at shutdown
  struct NextJob {
    std::shared_ptr<JobStateMachine> job;            // null: none may start now
    absl::Duration wait = absl::InfiniteDuration();  // until one may although nothing changes
  };
  NextJob FindNext();  // call with mutex_ held
  void RunOne(JobStateMachine* job);
  // Saves the state that `end` will bring the job to, and then brings it there.
  void End(JobStateMachine* job, const EndJob& end);
  bool SaveUntilDone(JobStateMachine* job, const JobSnapshot& ended);  // false at shutdown
  bool Save(JobStateMachine* job);
  void Forget(const JobStateMachine& job);  // that has ended and is saved

  const JobManagerOptions options_;
  const RunJob run_;
  JobJournal* const journal_;
  std::atomic<bool> shutting_down_ = false;

  // Taken before mutex_ and held while a new job is saved: one after the other, so the order in the
  // store is the order in the queue.
  mutable std::mutex create_mutex_;
  mutable std::mutex mutex_;         // never held while a job is saved
  std::condition_variable changed_;  // the queue, or what a worker may take from it
  std::condition_variable stopped_;  // shutting_down_
  // Returns the job of `draft.request_id` as it is now, if there is one.
  absl::StatusOr<std::optional<JobInfo>> FindRequest(const JobInfo& draft) const;
  // Why the queue has no place for the job. Call with mutex_ held.
  absl::Status CheckQueue(const JobInfo& draft) const;
  // Makes the job known, and lets it wait if it is queued. Call with mutex_ held.
  void Register(std::shared_ptr<JobStateMachine> job);

  struct Registered {
    std::shared_ptr<JobStateMachine> job;
    uint64_t number = 0;  // in the order of creation
  };
  // Those that have not ended, and such as failed at the start and could not be saved.
  std::map<std::string, Registered> jobs_;  // by id; guarded by mutex_
  std::map<uint64_t, std::string> order_;   // ids by number; guarded by mutex_
  uint64_t next_number_ = 0;                // guarded by mutex_
  JobQueue queue_;                          // guarded by mutex_
  std::set<std::string> suspects_;          // ids of jobs that run alone; guarded by mutex_
  int num_running_ = 0;                     // guarded by mutex_
  bool runs_suspect_ = false;               // guarded by mutex_
  std::vector<std::thread> workers_;
};

}  // namespace pleat
