// Files that the store does not trust or does not know. They are kept, out of the way.
#pragma once

#include <cstdint>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "pleat/store/sync_hook.h"

namespace pleat {

struct QuarantinedFile {
  std::string name;  // in the folder of the quarantine
  // When it came there, as in "2026-11-30T17:45:00Z"; empty when nobody wrote it down.
  std::string time{};
  std::string reason{};  // "no entry names it"
  uint64_t size_bytes = 0;
};

// The folder DATA/quarantine with a manifest of one line for each file that ever came. Pleat
// removes nothing from it but what `pleat store repair` has put back: an operator looks at it
// (`pleat store check`), repairs, or removes files. Thread-safe.
class Quarantine {
 public:
  explicit Quarantine(std::string folder, SyncHook before_sync = {})
      : folder_(std::move(folder)), before_sync_(std::move(before_sync)) {}

  // Moves the file `path`, which must be on the same disk, and writes down why. The line of the
  // manifest is durable before the file moves; on an error the file stays where it is.
  absl::Status Take(const std::string& path, const std::string& reason);

  // What is there now, by name. Files that somebody else has put there have an empty time.
  absl::StatusOr<std::vector<QuarantinedFile>> List() const;
  const std::string& folder() const { return folder_; }

 private:
  absl::Status WriteDown(const std::string& name, const std::string& reason);

  const std::string folder_;
  const SyncHook before_sync_;
  std::mutex mutex_;  // one move at a time
};

}  // namespace pleat
