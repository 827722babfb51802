// Whether a catalog and a folder of files belong together.
#pragma once

#include <cstddef>
#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"

namespace pleat {

// A store has a random id that stands in its catalog and in DATA/blobs/STORE. A catalog that is
// new, restored from somewhere else, or lies beside an empty folder because a disk is not mounted
// would make every file look unknown, or every entry look lost. So what does not agree is refused.
struct StoreSides {
  std::string catalog_id{};  // empty: never written, as in a new store or in one of version 0.1.0
  std::string blobs_id{};    // the same
  size_t num_named = 0;      // files that the rows name
  size_t num_files = 0;      // files that are there
  size_t num_common = 0;     // files that are there and named
};

// Returns the id for both sides: that of either side, or "" when the store needs a new one.
// kFailedPrecondition says what does not fit and what to do.
absl::StatusOr<std::string> AgreeOnStoreId(const StoreSides& sides, const std::string& data_dir);

// Returns 32 random hexadecimal digits.
std::string MakeStoreId();

// The id in the folder of files; empty when none is there. kDataLoss when the file holds something
// else.
absl::StatusOr<std::string> ReadBlobsId(const std::string& blobs_folder);
absl::Status WriteBlobsId(const std::string& blobs_folder, const std::string& id);

}  // namespace pleat
