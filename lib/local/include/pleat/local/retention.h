// What is removed because its time is over: entries with a time to live, jobs that ended long ago
// or that are too many, and uploads that nobody goes on with.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>

#include "absl/time/time.h"
#include "pleat/local/stored_files.h"

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

struct RetentionTarget {
  StoredFiles* files = nullptr;  // of any project: retention is about all of the store behind them
  std::function<void(const std::string& id)> on_model_removed{};  // may be empty
  // Receives one sentence about each thing that was removed, with its name. May be empty.
  std::function<void(const std::string& sentence)> on_removed{};
};

// Removes what the rules say, at the time that the clock of the files tells, and returns how many
// things that were. What cannot be removed is reported to the operator (Store::Report). A pinned
// entry is never removed, nor is a sequence that a job works on which has not ended. What a run
// costs depends on what it removes, and not on how much stays. May run beside everything else.
size_t RunRetention(const RetentionTarget& target, const RetentionRules& rules);

}  // namespace pleat
