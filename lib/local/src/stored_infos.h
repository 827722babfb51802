// Read rows of the catalog as the descriptions that they hold.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "absl/status/statusor.h"
#include "pleat/base/status.h"
#include "pleat/local/stored_files.h"
#include "pleat/service/list_page.h"
#include "pleat/store/records.h"

namespace pleat {

// Says which kind of entry a description belongs to, and how its row is decoded.
template <typename Info>
struct StoredKind;
template <>
struct StoredKind<SequenceInfo> {
  static constexpr EntryKind kind = EntryKind::kSequence;
  static constexpr auto decode = &DecodeSequenceRecord;
};
template <>
struct StoredKind<ModelInfo> {
  static constexpr EntryKind kind = EntryKind::kModel;
  static constexpr auto decode = &DecodeModelRecord;
};
template <>
struct StoredKind<JobInfo> {
  static constexpr EntryKind kind = EntryKind::kJob;
  static constexpr auto decode = &DecodeJobRecord;
};
template <>
struct StoredKind<CompressedSequenceInfo> {
  static constexpr EntryKind kind = EntryKind::kCompressedSequence;
  static constexpr auto decode = &DecodeCompressedSequenceRecord;
};

EntryLife LifeOf(const CatalogEntry& entry);

// Returns what a row says: its record, and when the entry came. Jobs keep their times themselves.
template <typename Info>
absl::StatusOr<Info> InfoOf(const CatalogEntry& entry) {
  PLEAT_ASSIGN_OR_RETURN(Info info, StoredKind<Info>::decode(entry.record));
  if constexpr (StoredKind<Info>::kind == EntryKind::kJob) {
    info.project = entry.project;
  } else {
    info.life = LifeOf(entry);
  }
  return info;
}

template <typename Info>
absl::StatusOr<Info> GetStored(ProjectCatalog& catalog, const std::string& id) {
  PLEAT_ASSIGN_OR_RETURN(const CatalogEntry entry, catalog.Get(StoredKind<Info>::kind, id));
  return InfoOf<Info>(entry);
}

// Returns the upload of a file that is stored and intact, and keeps it for `ttl` from now on; null
// when it has to be uploaded.
template <typename Info>
absl::StatusOr<std::unique_ptr<ContentUpload<Info>>> FindComplete(StoredFiles* files,
                                                                  const std::string& id,
                                                                  absl::Duration ttl) {
  constexpr EntryKind kKind = StoredKind<Info>::kind;
  if (!GetStored<Info>(files->catalog(), id).ok()) {
    const std::optional<CatalogEntry> shared = files->FindShared(kKind, id);
    if (!shared) return nullptr;
    PLEAT_RETURN_IF_ERROR(files->TakeShared(kKind, *shared, ttl));
  } else if (!files->IsIntact(id)) {
    return nullptr;
  }
  const absl::Status prolonged = files->Prolong(kKind, id, ttl);
  if (absl::IsNotFound(prolonged)) return nullptr;  // deleted in this moment
  PLEAT_RETURN_IF_ERROR(prolonged);
  absl::StatusOr<Info> info = GetStored<Info>(files->catalog(), id);
  if (!info.ok()) return nullptr;
  return std::make_unique<KnownUpload<Info>>(*std::move(info));
}

// The rows of one page, and the token of the next one.
struct EntryPage {
  std::vector<CatalogEntry> entries;
  std::string next_token;
};
absl::StatusOr<EntryPage> ReadEntryPage(StoredFiles* files, EntryKind kind,
                                        const PageRequest& request);

// Leaves out rows that cannot be read, and tells the operator: one of them must not hide the
// others.
template <typename Info>
absl::StatusOr<Page<Info>> ListStoredPage(StoredFiles* files, const PageRequest& request) {
  constexpr EntryKind kKind = StoredKind<Info>::kind;
  PLEAT_ASSIGN_OR_RETURN(EntryPage rows, ReadEntryPage(files, kKind, request));
  Page<Info> page{.items = {}, .next_token = std::move(rows.next_token)};
  for (const CatalogEntry& entry : rows.entries) {
    absl::StatusOr<Info> info = InfoOf<Info>(entry);
    if (info.ok()) {
      page.items.push_back(*std::move(info));
    } else {
      files->ReportBadRow(kKind, entry.id, info.status());
    }
  }
  return page;
}

}  // namespace pleat
