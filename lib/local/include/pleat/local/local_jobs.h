// The jobs of one project: they are checked here and then queued, stored and run by the JobPool.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <utility>

#include "pleat/local/job_pool.h"
#include "pleat/local/job_runner.h"
#include "pleat/local/local_sequences.h"
#include "pleat/local/project_quota.h"
#include "pleat/local/stored_files.h"
#include "pleat/service/job_service.h"

namespace pleat {

// A job of another project is as unknown as one that never was. Thread-safe. All arguments must
// outlive it.
class LocalJobs final : public JobService {
 public:
  // job_time: what the jobs of the project may use; null: no limit.
  LocalJobs(StoredFiles* files, LocalSequences* sequences, JobRunner runner, JobPool* pool,
            ProjectQuota* job_time = nullptr)
      : files_(files),
        sequences_(sequences),
        runner_(std::move(runner)),
        pool_(pool),
        job_time_(job_time) {}

  const JobRunner& runner() const { return runner_; }

  absl::StatusOr<JobInfo> CreateTraining(const TrainingRequest& request) override;
  absl::StatusOr<JobInfo> CreateCompression(const CompressionRequest& request) override;
  absl::StatusOr<JobInfo> Get(const std::string& id) override;
  absl::StatusOr<Page<JobInfo>> ListPage(const PageRequest& request) override;
  absl::Status Cancel(const std::string& id) override;
  absl::Status Delete(const std::string& id) override;
  absl::StatusOr<std::unique_ptr<JobSubscription>> Subscribe(
      const std::string& id, std::function<void()> listener) override;

 private:
  // Refuses a job for which the project has no room or no processor time left.
  absl::Status CheckProject();

  StoredFiles* const files_;
  LocalSequences* const sequences_;
  const JobRunner runner_;
  JobPool* const pool_;
  ProjectQuota* const job_time_;
};

}  // namespace pleat
