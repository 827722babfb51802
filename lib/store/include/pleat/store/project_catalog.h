// The catalog as one project sees it.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "pleat/store/catalog.h"

namespace pleat {

// Every question and every change is about entries of the project: whoever has this and no Catalog
// cannot reach the entries of others, nor learn that there are any. Thread-safe, like the catalog,
// which must outlive it.
class ProjectCatalog {
 public:
  ProjectCatalog(Catalog* catalog, std::string project)
      : catalog_(catalog), project_(std::move(project)) {}

  const std::string& project() const { return project_; }

  absl::Status Put(EntryKind kind, CatalogEntry entry) {
    entry.project = project_;
    return catalog_->Put(kind, entry);
  }
  absl::StatusOr<CatalogEntry> Get(EntryKind kind, const std::string& id) {
    return catalog_->Get({kind, project_}, id);
  }
  absl::StatusOr<std::vector<CatalogEntry>> ListPage(EntryKind kind, int64_t after_position,
                                                     int max_entries) {
    return catalog_->ListPage({kind, project_}, after_position, max_entries);
  }
  absl::Status Delete(EntryKind kind, const std::string& id) {
    return catalog_->Delete({kind, project_}, id);
  }
  absl::Status SetPinned(EntryKind kind, const std::string& id, bool pinned) {
    return catalog_->SetPinned({kind, project_}, id, pinned);
  }
  absl::Status Prolong(EntryKind kind, const std::string& id, int64_t expires_unix_ms) {
    return catalog_->Prolong({kind, project_}, id, expires_unix_ms);
  }
  absl::StatusOr<uint64_t> FileBytes() { return catalog_->ProjectBytes(project_); }

 private:
  Catalog* const catalog_;
  const std::string project_;
};

}  // namespace pleat
