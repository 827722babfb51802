// What is removed because its time is over: entries with a time to live, jobs that ended long ago
// or that are too many, and uploads that nobody goes on with.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/time/time.h"
#include "pleat/base/project.h"
#include "pleat/local/stored_files.h"
#include "pleat/service/job_service.h"

namespace pleat {

// Entries go when their own time to live is over, whatever the rules.
struct RetentionRules {
  int64_t max_ended_jobs = 0;  // the newest that stay of each project; 0: all
  // How long a job stays after its end. Jobs of older versions do not know when they ended; age
  // does not remove them.
  absl::Duration max_job_age = absl::InfiniteDuration();
  // How long an upload stays after its last byte.
  absl::Duration max_upload_age = absl::Hours(7 * 24);
};

struct EndedJob {
  std::string id{};
  std::string name{};                 // of its result
  std::optional<absl::Time> ended{};  // none: not known, so it counts as older than all others
  std::string project = kDefaultProject;
};

struct JobToRemove {
  EndedJob job;
  std::string why;  // "it ended more than 2 h ago"
};

// Chooses the jobs that the rules remove. jobs: in the order of their creation.
std::vector<JobToRemove> ChooseJobsToRemove(std::vector<EndedJob> jobs, const RetentionRules& rules,
                                            absl::Time now);

using SequenceOfProject = std::pair<std::string, std::string>;  // project and id
// Adds the sequences that a job works on, unless it has ended.
void AddSequencesInUse(const JobInfo& job, std::set<SequenceOfProject>* in_use);

// What retention has to do with the jobs of all projects.
struct JobsOfRetention {
  std::function<absl::StatusOr<std::vector<EndedJob>>()> ended;  // in the order of their creation
  std::function<absl::Status(const EndedJob& job)> remove;
  // The sequences that jobs which have not ended work on: these stay meanwhile.
  std::function<absl::StatusOr<std::set<SequenceOfProject>>()> sequences_in_use;
};

// The jobs in the rows of a store whose jobs nobody runs at the moment. `files` must outlive it.
JobsOfRetention JobsInRows(StoredFiles* files);

struct RetentionTarget {
  StoredFiles* files = nullptr;  // of any project: retention is about all of the store behind them
  JobsOfRetention jobs{};
  std::function<void(const std::string& id)> on_model_removed{};  // may be empty
  // Receives one sentence about each thing that was removed, with its name. May be empty.
  std::function<void(const std::string& sentence)> on_removed{};
};

// Removes what the rules say, at the time that the clock of the files tells, and returns how many
// things that were. What cannot be removed is reported to the operator (Store::Report). A pinned
// entry is never removed. May run beside everything else.
size_t RunRetention(const RetentionTarget& target, const RetentionRules& rules);

}  // namespace pleat
