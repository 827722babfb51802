// The exit codes of `pleat`: one for each kind of failure, the same for every verb
// (client/README.md).
#pragma once

#include <string>

#include "absl/status/status.h"

namespace pleat {

enum class ExitCode : int {
  kOk = 0,
  kInternal = 1,     // a fault of Pleat itself
  kUsage = 2,        // an unknown verb or flag, or a wrong value of a flag
  kBadInput = 3,     // a file that cannot be read as what it should be
  kNotFound = 4,     // a file, sequence, job or model that is not there
  kRefused = 5,      // input that is read but not possible: no human-like rig, a failed job
  kUnavailable = 6,  // the server cannot be reached or did not answer in time
  kCancelled = 7,    // Ctrl-C, or the job was cancelled
  kLimit = 8,        // over a limit of size, memory or disk
};

ExitCode ExitCodeOf(const absl::Status& status);

// Makes an error for a mistake in the command line that the parser cannot see. It ends with
// ExitCode::kUsage.
absl::Status UsageError(const std::string& message);
bool IsUsageError(const absl::Status& status);

// Returns the table of codes as --help prints it.
const char* ExitCodeHelp();

}  // namespace pleat
