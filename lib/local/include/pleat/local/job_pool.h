// The jobs of all projects of this process: one queue, one set of workers, rows in the catalog.
#pragma once

#include <functional>
#include <string>

#include "pleat/jobs/job_manager.h"
#include "pleat/local/job_runner.h"
#include "pleat/local/retention.h"
#include "pleat/local/stored_files.h"

namespace pleat {

struct JobPoolOptions {
  int num_workers = 1;              // jobs that run at the same time
  int max_queued_per_client = 250;  // this and the next two: see JobManagerOptions
  int max_queued_per_project = 0;
  bool in_idle_time = false;
  // Receives a job whenever a new state of it has been saved, from any thread. May be empty.
  std::function<void(const JobInfo& job)> on_state{};
  std::function<void(const std::string& stage, double seconds)>
      on_stage{};  // see JobManagerOptions
};

// Knows no projects but by the name that each job carries; LocalJobs shows a project its own.
// Thread-safe. `files` must outlive it.
class JobPool {
 public:
  // The runner that does the work of a project's jobs, with what the project may see. It is asked
  // from the threads of the workers.
  using RunnerOf = std::function<const JobRunner&(const std::string& project)>;

  // files: of any project; the pool uses the store behind them.
  JobPool(StoredFiles* files, RunnerOf runner_of, const JobPoolOptions& options);

  JobManager& manager() { return manager_; }
  // For retention; this object must outlive it.
  JobsOfRetention retention();
  size_t CountInState(JobState state) const { return manager_.CountInState(state); }

  // Takes over the jobs of the process before and starts the workers. Call once.
  absl::Status Start();
  // Stops the workers and ends all subscriptions. Jobs that run are queued for the next process.
  void Shutdown() { manager_.Shutdown(); }

 private:
  // Hands the stored jobs to the manager, and deletes the rigs that no unfinished job needs.
  absl::Status Restore();

  StoredFiles* const files_;
  const RunnerOf runner_of_;
  JobManager manager_;
};

}  // namespace pleat
