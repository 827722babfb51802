// The rows of jobs, of all projects: the journal of the job manager, and what else is asked of
// them.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "pleat/jobs/job_journal.h"
#include "pleat/local/stored_files.h"

namespace pleat {

// Thread-safe. `files`, of any project, must outlive it.
class JobRows final : public JobJournal {
 public:
  // on_state: receives a job whenever a new state of it has been saved. May be empty.
  JobRows(StoredFiles* files, std::function<void(const JobInfo& job)> on_state)
      : files_(files), on_state_(std::move(on_state)) {}

  absl::Status Save(const JobInfo& info, int attempts) override;
  absl::Status Erase(const JobInfo& info) override;
  absl::StatusOr<StoredJob> Read(const std::string& project, const std::string& id) override;
  absl::StatusOr<StoredJob> FindRequest(const std::string& project,
                                        const std::string& request_id) override;

 private:
  StoredFiles* const files_;
  const std::function<void(const JobInfo& job)> on_state_;
};

// The row of a job.
CatalogEntry JobEntry(const JobInfo& info, int attempts);

struct UnfinishedJobs {
  std::vector<StoredJob> jobs;  // of all projects, oldest first
  // False when there may be more, in rows that cannot be read.
  bool all_rows_are_read = true;
};
// Reads the jobs that have not ended. It notes the states of jobs in rows of older versions first,
// once for ever; rows that cannot be read are left out, and the operator is told.
absl::StatusOr<UnfinishedJobs> ReadUnfinishedJobs(StoredFiles* files);

}  // namespace pleat
