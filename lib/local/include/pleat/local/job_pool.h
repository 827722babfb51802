// The jobs of all projects of this process: one queue, one set of workers, rows in the catalog.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <string>

#include "pleat/jobs/job_manager.h"
#include "pleat/local/job_runner.h"
#include "pleat/local/stored_files.h"

namespace pleat {

struct UnfinishedJobs;  // src/job_rows.h

struct JobPoolOptions {
  int num_workers = 1;              // jobs that run at the same time
  int max_queued_per_client = 250;  // this and the next two: see JobManagerOptions
  int max_queued_per_project = 0;
  bool in_idle_time = false;
  // Receives a job whenever a new state of it has been saved, from any thread. May be empty.
  std::function<void(const JobInfo& job)> on_state{};
  // See JobManagerOptions for these.
  std::function<void(const std::string& stage, double seconds)> on_stage{};
  std::function<void(const std::string& project, double seconds)> on_processor_time{};
  std::function<absl::Duration(const std::string& project)> waiting_time{};
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
  // Counts the jobs of all projects, as the rows say. 0 when the catalog cannot be read.
  size_t CountInState(JobState state) const;

  // Takes over the jobs of the process before and starts the workers. Call once.
  absl::Status Start();
  // Stops the workers and ends all subscriptions. Jobs that run are queued for the next process.
  void Shutdown() { manager_.Shutdown(); }

 private:
  // Hands the stored jobs that have not ended to the manager, and deletes the rigs and checkpoints
  // that none of them needs.
  absl::Status Restore();
  absl::Status RemoveFilesOfEndedJobs(const UnfinishedJobs& unfinished);

  StoredFiles* const files_;
  const RunnerOf runner_of_;
  const std::unique_ptr<JobJournal> journal_;
  JobManager manager_;
};

}  // namespace pleat
