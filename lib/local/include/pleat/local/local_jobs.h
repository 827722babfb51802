// The jobs of this process: they are checked, queued, stored in the catalog and run by workers.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "pleat/jobs/job_manager.h"
#include "pleat/local/job_runner.h"
#include "pleat/local/local_sequences.h"
#include "pleat/local/retention.h"
#include "pleat/local/stored_files.h"
#include "pleat/service/job_service.h"

namespace pleat {

struct LocalJobsOptions {
  int num_workers = 1;              // jobs that run at the same time
  int max_queued_per_client = 250;  // this and the next: see JobManagerOptions
  bool in_idle_time = false;
  // Receives a job whenever a new state of it has been saved, from any thread. May be empty.
  std::function<void(const JobInfo& job)> on_state{};
};

// Thread-safe. `files` and `sequences` must outlive it.
class LocalJobs final : public JobService {
 public:
  LocalJobs(StoredFiles* files, LocalSequences* sequences, JobRunner runner,
            const LocalJobsOptions& options);

  absl::StatusOr<JobInfo> CreateTraining(const TrainingRequest& request) override;
  absl::StatusOr<JobInfo> CreateCompression(const CompressionRequest& request) override;
  absl::StatusOr<JobInfo> Get(const std::string& id) override;
  absl::StatusOr<Page<JobInfo>> ListPage(const PageRequest& request) override;
  absl::Status Cancel(const std::string& id) override;
  absl::Status Delete(const std::string& id) override;
  absl::StatusOr<std::unique_ptr<JobSubscription>> Subscribe(
      const std::string& id, std::function<void()> listener) override;

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
  LocalSequences* const sequences_;
  const JobRunner runner_;
  JobManager manager_;
};

}  // namespace pleat
