#include "folder_lock.h"

#include <unistd.h>

#include <optional>
#include <utility>

#include "absl/strings/str_cat.h"
#include "pleat/base/file.h"
#include "pleat/base/status.h"

namespace pleat {

absl::StatusOr<FileLock> LockFolder(const std::string& data_dir) {
  const std::string path = data_dir + "/lock";
  PLEAT_ASSIGN_OR_RETURN(std::optional<FileLock> lock, FileLock::Try(path, 0644));
  if (!lock) {
    const absl::StatusOr<std::string> holder = ReadFile(path, 64);
    return absl::FailedPreconditionError(
        absl::StrCat("the data folder '", data_dir, "' is in use by another process",
                     holder.ok() && !holder->empty() ? absl::StrCat(" (", *holder, ")") : "",
                     "; stop it or choose another --data-dir"));
  }
  lock->Note(absl::StrCat("process ", getpid()));
  return *std::move(lock);
}

}  // namespace pleat
