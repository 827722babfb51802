#include "pleat/store/store_check.h"

#include <algorithm>
#include <filesystem>
#include <system_error>
#include <unordered_set>
#include <utility>

#include "absl/strings/str_cat.h"
#include "pleat/base/status.h"
#include "pleat/store/blob_store.h"
#include "record_kinds.h"
#include "store_identity.h"

namespace pleat {
namespace {

class StoreInspection {
 public:
  StoreInspection(Catalog* catalog, const BlobStore* blobs, bool verify_files)
      : catalog_(catalog), blobs_(blobs), verify_files_(verify_files) {}

  absl::Status ReadRows() {
    for (const EntryKind kind : kEntryKinds) {
      PLEAT_ASSIGN_OR_RETURN(const std::vector<CatalogEntry> entries, catalog_->List(kind));
      check_.num_entries[static_cast<size_t>(kind)] = entries.size();
      for (const CatalogEntry& entry : entries) {
        if (const absl::Status status = CheckRecord(kind, entry.record); !status.ok()) {
          Add(StoreProblem::Kind::kBadRow, entry.id,
              absl::StrCat("the row of the ", EntryKindName(kind), " '", entry.id,
                           "' cannot be read: ", std::string(status.message())));
        }
      }
    }
    return absl::OkStatus();
  }

  absl::Status ReadFiles(const Progress& progress) {
    PLEAT_ASSIGN_OR_RETURN(const std::vector<std::string> named, catalog_->FileIds());
    PLEAT_ASSIGN_OR_RETURN(const std::vector<std::string> files, blobs_->List());
    num_named_ = named.size();
    num_present_ = files.size();
    for (size_t i = 0; i < named.size(); ++i) {
      PLEAT_RETURN_IF_ERROR(progress.Report(static_cast<double>(i) / named.size()));
      CheckFile(named[i]);
    }
    const std::unordered_set<std::string> known(named.begin(), named.end());
    for (const std::string& id : files) {
      // The row of a new file comes last, and the file of a deleted row goes last.
      if (known.contains(id) || catalog_->NamesFile(id).value_or(true)) continue;
      if (!blobs_->Contains(id)) continue;
      Add(StoreProblem::Kind::kUnknownFile, id, absl::StrCat("no entry names the file '", id, "'"));
    }
    return progress.Report(1);
  }

  absl::Status CheckIdentity(const std::string& data_dir) {
    StoreSides sides{
        .num_named = num_named_, .num_files = num_present_, .num_common = check_.num_files};
    PLEAT_ASSIGN_OR_RETURN(sides.catalog_id, catalog_->StoreId());
    const absl::StatusOr<std::string> blobs_id = ReadBlobsId(blobs_->folder());
    absl::Status status = blobs_id.status();
    if (status.ok()) {
      sides.blobs_id = *blobs_id;
      status = AgreeOnStoreId(sides, data_dir).status();
    }
    check_.store_id = sides.catalog_id;
    if (!status.ok()) Add(StoreProblem::Kind::kIdentity, "", std::string(status.message()));
    return absl::OkStatus();
  }

  StoreCheck Take() {
    std::ranges::stable_sort(check_.problems, {}, [](const StoreProblem& problem) {
      return std::pair(problem.kind, problem.id);
    });
    return std::move(check_);
  }
  StoreCheck& check() { return check_; }

 private:
  void Add(StoreProblem::Kind kind, const std::string& id, std::string text) {
    check_.problems.push_back({kind, id, std::move(text)});
  }

  void CheckFile(const std::string& id) {
    const absl::StatusOr<uint64_t> size = blobs_->Size(id);
    absl::Status status = size.status();
    if (status.ok() && verify_files_) status = blobs_->Verify(id);
    if (size.ok()) {
      ++check_.num_files;
      check_.num_bytes += *size;
    }
    if (status.ok() || !catalog_->NamesFile(id).value_or(true)) return;  // deleted meanwhile
    check_.problems.push_back(FileProblem(id, status));
  }

  Catalog* const catalog_;
  const BlobStore* const blobs_;
  const bool verify_files_;
  StoreCheck check_;
  size_t num_named_ = 0, num_present_ = 0;
};

}  // namespace

const char* StoreProblemName(StoreProblem::Kind kind) {
  switch (kind) {
    case StoreProblem::Kind::kIdentity:
      return "identity";
    case StoreProblem::Kind::kBadRow:
      return "bad row";
    case StoreProblem::Kind::kMissingFile:
      return "missing file";
    case StoreProblem::Kind::kDamagedFile:
      return "damaged file";
    case StoreProblem::Kind::kUnreadableFile:
      return "unreadable file";
    case StoreProblem::Kind::kUnknownFile:
      return "unknown file";
  }
  return "unknown";
}

StoreProblem FileProblem(const std::string& id, const absl::Status& why) {
  const auto kind = absl::IsNotFound(why)   ? StoreProblem::Kind::kMissingFile
                    : absl::IsDataLoss(why) ? StoreProblem::Kind::kDamagedFile
                                            : StoreProblem::Kind::kUnreadableFile;
  return {kind, id, std::string(why.message())};
}

absl::StatusOr<StoreCheck> CheckStore(const std::string& data_dir, bool verify_files,
                                      const Progress& progress) {
  const std::string catalog_path = CatalogPath(data_dir);
  std::error_code error;
  if (!std::filesystem::exists(catalog_path, error)) {
    return absl::NotFoundError(absl::StrCat("'", data_dir,
                                            "' has no catalogue.db: it is no data "
                                            "folder, or its catalog was removed"));
  }
  PLEAT_ASSIGN_OR_RETURN(const std::unique_ptr<Catalog> catalog,
                         Catalog::OpenReadOnly(catalog_path));
  const BlobStore blobs = BlobStore::OpenReadOnly(data_dir + "/blobs");
  StoreInspection inspection(catalog.get(), &blobs, verify_files);
  PLEAT_RETURN_IF_ERROR(inspection.ReadRows());
  if (std::filesystem::exists(data_dir + "/blobs", error)) {
    PLEAT_RETURN_IF_ERROR(inspection.ReadFiles(progress.Stage("files", 0, 1)));
  }
  PLEAT_RETURN_IF_ERROR(inspection.CheckIdentity(data_dir));
  PLEAT_ASSIGN_OR_RETURN(inspection.check().quarantine,
                         Quarantine(data_dir + "/quarantine").List());
  return inspection.Take();
}

}  // namespace pleat
