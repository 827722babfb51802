#include "pleat/store/store_repair.h"

#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <system_error>
#include <unordered_set>
#include <utility>

#include "absl/strings/str_cat.h"
#include "folder_lock.h"
#include "pleat/base/content_id.h"
#include "pleat/base/file.h"
#include "pleat/base/sha256.h"
#include "pleat/base/status.h"
#include "pleat/store/blob_store.h"
#include "pleat/store/quarantine.h"
#include "record_kinds.h"
#include "store_identity.h"

namespace pleat {
namespace {

namespace fs = std::filesystem;

class StoreRepairer {
 public:
  StoreRepairer(const std::string& data_dir, const DescribeFile& describe)
      : data_dir_(data_dir), describe_(describe), quarantine_(data_dir + "/quarantine") {}

  absl::StatusOr<StoreRepair> Run(const Progress& progress) {
    std::error_code error;
    if (!fs::is_directory(data_dir_ + "/blobs", error)) {
      return absl::NotFoundError(
          absl::StrCat("'", data_dir_, "' has no folder 'blobs': it is no data folder"));
    }
    PLEAT_ASSIGN_OR_RETURN(const FileLock lock, LockFolder(data_dir_));
    PLEAT_RETURN_IF_ERROR(OpenCatalog());
    PLEAT_ASSIGN_OR_RETURN(BlobStore blobs, BlobStore::Open(data_dir_ + "/blobs", 0));
    blobs_ = std::make_unique<BlobStore>(std::move(blobs));
    PLEAT_RETURN_IF_ERROR(Identify());
    PLEAT_RETURN_IF_ERROR(FindGoodRows());
    PLEAT_RETURN_IF_ERROR(RepairFiles(progress.Stage("files", 0, .8)));
    PLEAT_RETURN_IF_ERROR(ReturnFiles(progress.Stage("quarantine", .8, 1)));
    PLEAT_RETURN_IF_ERROR(FindMissing());
    return std::move(repair_);
  }

 private:
  absl::Status OpenCatalog() {
    const std::string path = CatalogPath(data_dir_);
    absl::StatusOr<std::unique_ptr<Catalog>> catalog = Catalog::Open(path);
    if (absl::IsDataLoss(catalog.status())) {
      repair_.has_new_catalog = true;
      std::error_code error;
      for (const char* suffix : kCatalogSuffixes) {
        if (!fs::exists(path + suffix, error)) continue;
        PLEAT_RETURN_IF_ERROR(quarantine_.Take(path + suffix, "the catalog is damaged"));
      }
      catalog = Catalog::Open(path);
    }
    PLEAT_RETURN_IF_ERROR(catalog.status());
    catalog_ = *std::move(catalog);
    return absl::OkStatus();
  }

  // The operator has said that both sides belong together.
  absl::Status Identify() {
    PLEAT_ASSIGN_OR_RETURN(std::string id, catalog_->StoreId());
    if (id.empty()) {
      const absl::StatusOr<std::string> blobs_id = ReadBlobsId(blobs_->folder());
      id = blobs_id.ok() && !blobs_id->empty() ? *blobs_id : MakeStoreId();
    }
    PLEAT_RETURN_IF_ERROR(WriteBlobsId(blobs_->folder(), id));
    return catalog_->SetStoreId(id);
  }

  absl::Status FindGoodRows() {
    for (const EntryKind kind : kFileKinds) {
      PLEAT_ASSIGN_OR_RETURN(const std::vector<CatalogEntry> entries, catalog_->List(kind));
      for (const CatalogEntry& entry : entries) {
        if (CheckRecord(kind, entry.record).ok()) {
          good_rows_.insert(entry.id);
        } else {
          projects_of_bad_rows_[entry.id].insert(entry.project);
        }
      }
    }
    return absl::OkStatus();
  }

  absl::Status RepairFiles(const Progress& progress) {
    PLEAT_ASSIGN_OR_RETURN(const std::vector<std::string> files, blobs_->List());
    for (size_t i = 0; i < files.size(); ++i) {
      PLEAT_RETURN_IF_ERROR(progress.Report(static_cast<double>(i) / files.size()));
      const std::string& id = files[i];
      const absl::StatusOr<std::string> bytes = blobs_->Get(id);
      if (absl::IsDataLoss(bytes.status())) {
        PLEAT_RETURN_IF_ERROR(quarantine_.Take(blobs_->PathOf(id), "its content has changed"));
        repair_.damaged.push_back(id);
        continue;
      }
      PLEAT_RETURN_IF_ERROR(bytes.status());
      if (good_rows_.contains(id) && !projects_of_bad_rows_.contains(id)) continue;
      const absl::StatusOr<FileDescription> description = describe_(id, *bytes);
      if (description.ok()) {
        PLEAT_RETURN_IF_ERROR(MakeRow(id, *description));
      } else {
        repair_.unknown.push_back(id);
      }
    }
    return progress.Report(1);
  }

  // A row that cannot be read still says whose the file is. Nothing but a lost row knew it, and
  // then the file becomes the default project's.
  absl::Status MakeRow(const std::string& id, const FileDescription& description) {
    CatalogEntry entry{.id = id, .record = description.record};
    entry.file_bytes = blobs_->Size(id).value_or(0);
    const auto known = projects_of_bad_rows_.find(id);
    const std::set<std::string> projects = known == projects_of_bad_rows_.end()
                                               ? std::set<std::string>{kDefaultProject}
                                               : known->second;
    for (const std::string& project : projects) {
      entry.project = project;
      PLEAT_RETURN_IF_ERROR(catalog_->Put(description.kind, entry));
    }
    repair_.rows_made.push_back(id);
    return absl::OkStatus();
  }

  // A copy goes back, under the name that the content has; the file in quarantine goes only then.
  absl::Status ReturnFiles(const Progress& progress) {
    PLEAT_ASSIGN_OR_RETURN(const std::vector<QuarantinedFile> files, quarantine_.List());
    for (size_t i = 0; i < files.size(); ++i) {
      PLEAT_RETURN_IF_ERROR(progress.Report(static_cast<double>(i) / files.size()));
      const std::string id = files[i].name.substr(0, kContentIdLength);
      if (!IsContentId(id) || blobs_->Contains(id)) continue;
      const std::string path = absl::StrCat(quarantine_.folder(), "/", files[i].name);
      const absl::StatusOr<std::string> bytes = ReadFile(path);
      if (!bytes.ok() || ToHex(ComputeSha256(*bytes)) != id) continue;
      std::optional<FileDescription> missing_row;
      if (!good_rows_.contains(id)) {
        absl::StatusOr<FileDescription> description = describe_(id, *bytes);
        if (!description.ok()) continue;
        missing_row = *std::move(description);
      }
      PLEAT_RETURN_IF_ERROR(blobs_->Put(*bytes).status());
      if (missing_row) PLEAT_RETURN_IF_ERROR(MakeRow(id, *missing_row));
      std::error_code ignored;
      fs::remove(path, ignored);
      repair_.returned.push_back(id);
    }
    return progress.Report(1);
  }

  absl::Status FindMissing() {
    PLEAT_ASSIGN_OR_RETURN(const std::vector<std::string> named, catalog_->FileIds());
    for (const std::string& id : named) {
      if (!blobs_->Contains(id)) repair_.missing.push_back(id);
    }
    return absl::OkStatus();
  }

  const std::string data_dir_;
  const DescribeFile& describe_;
  Quarantine quarantine_;
  std::unique_ptr<Catalog> catalog_;
  std::unique_ptr<BlobStore> blobs_;
  std::unordered_set<std::string> good_rows_;  // ids of entries whose record can be read
  std::map<std::string, std::set<std::string>> projects_of_bad_rows_;  // by id, for the others
  StoreRepair repair_;
};

}  // namespace

absl::StatusOr<StoreRepair> RepairStore(const std::string& data_dir, const DescribeFile& describe,
                                        const Progress& progress) {
  return StoreRepairer(data_dir, describe).Run(progress);
}

}  // namespace pleat
