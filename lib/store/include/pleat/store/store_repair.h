// Makes the rows of a catalog anew from the files.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "pleat/base/progress.h"
#include "pleat/store/catalog.h"

namespace pleat {

struct FileDescription {
  EntryKind kind = EntryKind::kSequence;
  std::string record;  // for the row
};
// Says what a file is, from its bytes alone; an error when they are nothing that a store keeps.
using DescribeFile =
    std::function<absl::StatusOr<FileDescription>(const std::string& id, const std::string& bytes)>;

struct StoreRepair {
  bool has_new_catalog = false;        // the damaged one is in quarantine
  std::vector<std::string> rows_made;  // ids of files that had no row, or one that cannot be read
  std::vector<std::string> returned;   // ids of files that came back from the quarantine
  std::vector<std::string> damaged;    // ids of files that went to the quarantine
  std::vector<std::string> unknown;    // ids of files of which nobody can say what they are
  std::vector<std::string> missing;    // ids of entries that still have no file
};

// Repairs the data folder of a server that does not run: gives catalog and files the same store id,
// moves what is damaged to the quarantine, returns from there what is intact, and adds the rows
// that are missing. It erases nothing. What only the catalog knew is lost with it: jobs, and the
// records of how models were trained where their files do not hold them.
// kFailedPrecondition when a process uses the folder, kNotFound when it has no files.
absl::StatusOr<StoreRepair> RepairStore(const std::string& data_dir, const DescribeFile& describe,
                                        const Progress& progress = {});

}  // namespace pleat
