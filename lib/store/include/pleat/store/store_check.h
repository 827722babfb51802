// What is in a data folder and what is wrong with it.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "pleat/base/progress.h"
#include "pleat/store/catalog.h"
#include "pleat/store/quarantine.h"

namespace pleat {

struct StoreProblem {
  enum class Kind {
    kIdentity,        // catalog and files do not belong together
    kBadRow,          // a row of the catalog that cannot be read
    kMissingFile,     // an entry whose file is not there
    kDamagedFile,     // a file whose content has changed
    kUnreadableFile,  // a file that the disk does not give
    kUnknownFile,     // a file that no entry names
  };
  Kind kind;
  std::string id;    // the entry or file; empty for kIdentity
  std::string text;  // a sentence for the operator
};
const char* StoreProblemName(StoreProblem::Kind kind);  // "missing file"

// The problem of the file `id` that `why`, an error of BlobStore, is about.
StoreProblem FileProblem(const std::string& id, const absl::Status& why);

struct StoreCheck {
  std::string store_id;                                      // empty: never written
  std::array<size_t, std::size(kEntryKinds)> num_entries{};  // by EntryKind
  size_t num_files = 0;                                      // that entries name and that are there
  uint64_t num_bytes = 0;                                    // of these files
  std::vector<StoreProblem> problems;  // in the order of the enumeration, then by id
  std::vector<QuarantinedFile> quarantine;
};

// Looks through a data folder, or a backup of one, and changes nothing. A server may use the folder
// meanwhile: what it adds or deletes in between is not reported as a problem.
// verify_files: read every file and compare its content with its id, instead of looking only
// whether it is there. kNotFound when there is no catalog, kDataLoss when it is damaged,
// kCancelled.
absl::StatusOr<StoreCheck> CheckStore(const std::string& data_dir, bool verify_files,
                                      const Progress& progress = {});

}  // namespace pleat
