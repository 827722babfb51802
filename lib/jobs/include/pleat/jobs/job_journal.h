// Where jobs are written down: what a manager does not keep in memory.
#pragma once

#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "pleat/service/job_service.h"

namespace pleat {

struct StoredJob {
  JobInfo info;
  int attempts = 0;  // how often the job was started
};

// Thread-safe: calls may come at the same time, for one job one after the other.
class JobJournal {
 public:
  virtual ~JobJournal() = default;
  // Writes the job down, durably; called at every change of state.
  virtual absl::Status Save(const JobInfo& info, int attempts) = 0;
  // Removes what Save wrote, durably.
  virtual absl::Status Erase(const JobInfo& info) = 0;
  // Returns what Save wrote last. kNotFound for an id that the project does not have.
  virtual absl::StatusOr<StoredJob> Read(const std::string& project, const std::string& id) = 0;
  // Returns the newest job that a request of the project made (JobInfo::request_id, not empty);
  // kNotFound when there is none.
  virtual absl::StatusOr<StoredJob> FindRequest(const std::string& project,
                                                const std::string& request_id) = 0;
};

}  // namespace pleat
