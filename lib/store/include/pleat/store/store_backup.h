// Copies of a data folder.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "pleat/base/progress.h"
#include "pleat/store/store_check.h"

namespace pleat {

struct StoreCopy {
  size_t num_copied = 0;  // files
  uint64_t bytes_copied = 0;
  size_t num_kept = 0;                 // files that the backup had already
  size_t num_removed = 0;              // files of the backup that nothing names any more
  std::vector<StoreProblem> problems;  // files that could not be copied
};

// Makes or renews a backup of `data_dir` in the folder `backup`; a server may use `data_dir`
// meanwhile. The backup is a data folder too. It holds the entries of one moment, without those
// that were deleted while it was made, and the file of every entry. Files are named by their
// content, so a renewal copies only what is new; every copied file is verified on the way. The
// catalog of the backup is replaced last: a backup that was interrupted still holds the state
// before. Uploads that have not ended are not part of it.
//
// Damaged and missing files are left out and named in `problems`. kFailedPrecondition when `backup`
// holds something else or the backup of another store, or when it is in use.
absl::StatusOr<StoreCopy> BackupStore(const std::string& data_dir, const std::string& backup,
                                      const Progress& progress = {});

// Copies a backup to `data_dir`, which must be missing or empty: kFailedPrecondition.
absl::StatusOr<StoreCopy> RestoreStore(const std::string& backup, const std::string& data_dir,
                                       const Progress& progress = {});

}  // namespace pleat
