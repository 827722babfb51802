// How the programs log: spdlog on standard error.
#pragma once

#include <string>

#include "absl/status/status.h"

namespace pleat {

struct LoggingOptions {
  std::string level = "info";  // "trace", "debug", "info", "warning", "error", "off"
  bool json = false;           // one JSON object per line: time, level, thread, message
};

// Sets the default logger of the process; call it once, before threads are started.
// kInvalidArgument lists the levels when options.level is none of them. What Protocol Buffers would
// print by itself becomes a debug line.
absl::Status ConfigureLogging(const LoggingOptions& options);

}  // namespace pleat
