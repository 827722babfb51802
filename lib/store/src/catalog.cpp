#include "pleat/store/catalog.h"

#include <mutex>
#include <utility>

#include "absl/strings/str_cat.h"
#include "catalog_rows.h"
#include "catalog_schema.h"
#include "database.h"
#include "pleat/base/status.h"
#include "sync_hook_vfs.h"

namespace pleat {

absl::StatusOr<std::vector<CatalogEntry>> ReadEntries(Statement* statement) {
  std::vector<CatalogEntry> entries;
  while (true) {
    PLEAT_ASSIGN_OR_RETURN(const bool found, statement->Step("read"));
    if (!found) return entries;
    entries.push_back({.id = statement->Bytes(0),
                       .record = statement->Bytes(1),
                       .attempts = statement->Int(2),
                       .created_unix_ms = statement->Int64(3),
                       .expires_unix_ms = statement->Int64(4),
                       .pinned = statement->Int(5) != 0,
                       .position = statement->Int64(6),
                       .project = statement->Bytes(7),
                       .file_bytes = static_cast<uint64_t>(statement->Int64(8)),
                       .job = {.state = statement->Bytes(9),
                               .ended_unix_ms = statement->Int64(10),
                               .request_id = statement->Bytes(11)}});
  }
}

absl::Status NotThere(EntryKind kind, const std::string& id) {
  return absl::NotFoundError(absl::StrCat("no ", EntryKindName(kind), " '", id, "'"));
}

const char* EntryKindName(EntryKind kind) {
  switch (kind) {
    case EntryKind::kSequence:
      return "sequence";
    case EntryKind::kModel:
      return "model";
    case EntryKind::kCompressedSequence:
      return "compressed sequence";
    case EntryKind::kJob:
      return "job";
    case EntryKind::kRig:
      return "rig";
    case EntryKind::kCheckpoint:
      return "checkpoint";
  }
  return "unknown";
}

std::string CatalogPath(const std::string& data_dir) { return data_dir + "/catalogue.db"; }

Catalog::Catalog() = default;

// The last connection to close writes the log back into the database, so it must be the writer.
Catalog::~Catalog() {
  reader_.reset();
  writer_.reset();
}

absl::StatusOr<std::unique_ptr<Catalog>> Catalog::Open(const std::string& path,
                                                       SyncHook before_sync) {
  std::unique_ptr<Catalog> catalog(new Catalog);
  if (before_sync) catalog->vfs_ = std::make_unique<SyncHookVfs>(std::move(before_sync));
  const char* vfs = catalog->vfs_ == nullptr ? nullptr : catalog->vfs_->name();
  PLEAT_ASSIGN_OR_RETURN(catalog->writer_, Database::Open(path, Database::Access::kReadWrite, vfs));
  PLEAT_RETURN_IF_ERROR(catalog->writer_->Execute("PRAGMA journal_mode=WAL"));
  PLEAT_RETURN_IF_ERROR(catalog->writer_->Execute("PRAGMA synchronous=FULL"));
  PLEAT_ASSIGN_OR_RETURN(const int version, catalog->CheckFile(path));
  if (version < kCatalogVersion) {
    PLEAT_RETURN_IF_ERROR(catalog->Upgrade(version));
  }
  PLEAT_ASSIGN_OR_RETURN(catalog->reader_, Database::Open(path, Database::Access::kReadWrite, vfs));
  PLEAT_RETURN_IF_ERROR(catalog->reader_->Execute("PRAGMA query_only=ON"));
  return catalog;
}

absl::StatusOr<std::unique_ptr<Catalog>> Catalog::OpenReadOnly(const std::string& path) {
  std::unique_ptr<Catalog> catalog(new Catalog);
  PLEAT_ASSIGN_OR_RETURN(catalog->writer_, Database::Open(path, Database::Access::kReadOnly));
  PLEAT_ASSIGN_OR_RETURN(const int version, catalog->CheckFile(path));
  if (version == 0) {
    return absl::DataLossError(absl::StrCat("the catalog '", path, "' is empty"));
  }
  catalog->has_properties_ = version >= 2;
  catalog->has_lives_ = version >= 3;
  catalog->has_projects_ = version >= 4;
  catalog->has_job_columns_ = version >= 5;
  PLEAT_ASSIGN_OR_RETURN(catalog->reader_, Database::Open(path, Database::Access::kReadOnly));
  return catalog;
}

absl::StatusOr<int> Catalog::CheckFile(const std::string& path) {
  {
    Statement check(writer_.get(), "PRAGMA quick_check(1)");
    PLEAT_ASSIGN_OR_RETURN(const bool row, check.Step("check"));
    if (!row || check.Bytes(0) != "ok") {
      return absl::DataLossError(
          absl::StrCat("the catalog '", path, "' is damaged: ", row ? check.Bytes(0) : "no answer",
                       "; restore it from a backup, or make its rows anew from the files with "
                       "'pleat store repair'"));
    }
  }
  Statement query(writer_.get(), "PRAGMA user_version");
  PLEAT_ASSIGN_OR_RETURN(const bool row, query.Step("read"));
  const int version = row ? query.Int(0) : 0;
  if (version <= kCatalogVersion) return version;
  return absl::FailedPreconditionError(absl::StrCat("the catalog '", path, "' has version ",
                                                    version, ", this program reads up to ",
                                                    kCatalogVersion, "; use a newer pleatd"));
}

absl::Status Catalog::Upgrade(int version) {
  absl::Status status = writer_->Execute(SchemaUpgrade(version));
  if (!status.ok()) writer_->Execute("ROLLBACK").IgnoreError();
  return status;
}

absl::StatusOr<std::string> Catalog::Secret() {
  std::lock_guard lock(reader_->mutex());
  Statement statement(reader_.get(), "SELECT value FROM properties WHERE name='secret'");
  PLEAT_ASSIGN_OR_RETURN(const bool found, statement.Step("read"));
  return found ? statement.Bytes(0) : std::string();
}

absl::StatusOr<std::string> Catalog::StoreId() {
  if (!has_properties_) return std::string();
  std::lock_guard lock(reader_->mutex());
  Statement statement(reader_.get(), "SELECT value FROM properties WHERE name='store'");
  PLEAT_ASSIGN_OR_RETURN(const bool found, statement.Step("read"));
  return found ? statement.Bytes(0) : std::string();
}

absl::Status Catalog::SetStoreId(const std::string& id) {
  std::lock_guard lock(writer_->mutex());
  Statement statement(writer_.get(), "INSERT OR REPLACE INTO properties VALUES ('store', ?1)");
  statement.Bind(1, id);
  return statement.Step("write").status();
}

absl::Status Catalog::Put(EntryKind kind, const CatalogEntry& entry) {
  std::lock_guard lock(writer_->mutex());
  return PutRow(kind, entry);
}

absl::Status Catalog::PutAll(EntryKind kind, const std::vector<CatalogEntry>& entries) {
  std::lock_guard lock(writer_->mutex());
  PLEAT_RETURN_IF_ERROR(writer_->Execute("BEGIN"));
  absl::Status status;
  for (const CatalogEntry& entry : entries) {
    status = PutRow(kind, entry);
    if (!status.ok()) break;
  }
  if (status.ok()) status = writer_->Execute("COMMIT");
  if (!status.ok()) writer_->Execute("ROLLBACK").IgnoreError();
  return status;
}

absl::Status Catalog::PutRow(EntryKind kind, const CatalogEntry& entry) {
  Statement statement(writer_.get(),
                      "INSERT INTO entries (kind, id, record, attempts, created_ms, expires_ms,"
                      " project, file_bytes, job_state, ended_ms, request_id)"
                      " VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8, ?9, ?10, ?11)"
                      " ON CONFLICT (project, kind, id) DO UPDATE SET record=?3, attempts=?4,"
                      " file_bytes=?8, job_state=?9, ended_ms=?10, request_id=?11, expires_ms="
                      "CASE WHEN expires_ms=0 OR ?6=0 THEN 0"
                      " WHEN expires_ms<?6 THEN ?6 ELSE expires_ms END");
  statement.Bind(1, EntryKindName(kind));
  statement.Bind(2, entry.id);
  statement.BindBlob(3, entry.record);
  statement.Bind(4, entry.attempts);
  statement.Bind(5, entry.created_unix_ms);
  statement.Bind(6, entry.expires_unix_ms);
  statement.Bind(7, entry.project);
  statement.Bind(8, static_cast<int64_t>(entry.file_bytes));
  statement.Bind(9, entry.job.state);
  statement.Bind(10, entry.job.ended_unix_ms);
  statement.Bind(11, entry.job.request_id);
  return statement.Step("write").status();
}

std::string Catalog::Select(const char* conditions) const {
  return absl::StrCat("SELECT id, record, attempts, ",
                      has_lives_ ? "created_ms, expires_ms, pinned" : "0, 0, 0", ", position, ",
                      has_projects_ ? "project, file_bytes" : "'default', 0",
                      has_job_columns_ ? ", job_state, ended_ms, request_id" : ", '', 0, ''",
                      " FROM entries ", conditions);
}

absl::StatusOr<CatalogEntry> Catalog::Get(const ProjectKind& kind, const std::string& id) {
  std::lock_guard lock(reader_->mutex());
  const char* const which = has_projects_ ? "WHERE project=?3 AND kind=?1 AND id=?2"
                                          : "WHERE ?3='default' AND kind=?1 AND id=?2";
  Statement statement(reader_.get(), Select(which).c_str());
  statement.Bind(1, EntryKindName(kind.kind));
  statement.Bind(2, id);
  statement.Bind(3, kind.project);
  PLEAT_ASSIGN_OR_RETURN(std::vector<CatalogEntry> found, ReadEntries(&statement));
  if (found.empty()) return NotThere(kind.kind, id);
  return std::move(found[0]);
}

absl::StatusOr<CatalogEntry> Catalog::GetInAnyProject(EntryKind kind, const std::string& id) {
  std::lock_guard lock(reader_->mutex());
  Statement statement(
      reader_.get(),
      Select("WHERE id=?2 AND kind=?1 AND kind <> 'job' ORDER BY position LIMIT 1").c_str());
  statement.Bind(1, EntryKindName(kind));
  statement.Bind(2, id);
  PLEAT_ASSIGN_OR_RETURN(std::vector<CatalogEntry> found, ReadEntries(&statement));
  if (found.empty()) return NotThere(kind, id);
  return std::move(found[0]);
}

absl::StatusOr<std::vector<CatalogEntry>> Catalog::List(EntryKind kind) {
  std::lock_guard lock(reader_->mutex());
  // Files have an index of their own, which knows of no jobs.
  Statement statement(
      reader_.get(),
      Select(kind == EntryKind::kJob ? "WHERE kind=?1 ORDER BY position"
                                     : "WHERE kind=?1 AND kind <> 'job' ORDER BY position")
          .c_str());
  statement.Bind(1, EntryKindName(kind));
  return ReadEntries(&statement);
}

absl::StatusOr<std::vector<CatalogEntry>> Catalog::ListPage(const ProjectKind& kind,
                                                            int64_t after_position,
                                                            int max_entries) {
  std::lock_guard lock(reader_->mutex());
  const char* const which =
      has_projects_ ? "WHERE project=?4 AND kind=?1 AND position>?2 ORDER BY position LIMIT ?3"
                    : "WHERE ?4='default' AND kind=?1 AND position>?2 ORDER BY position LIMIT ?3";
  Statement statement(reader_.get(), Select(which).c_str());
  statement.Bind(1, EntryKindName(kind.kind));
  statement.Bind(2, after_position);
  statement.Bind(3, max_entries);
  statement.Bind(4, kind.project);
  return ReadEntries(&statement);
}

uint64_t Catalog::num_read_steps() const { return reader_->num_steps(); }

absl::StatusOr<uint64_t> Catalog::ProjectBytes(const std::string& project) {
  if (!has_projects_) return 0;
  std::lock_guard lock(reader_->mutex());
  Statement statement(reader_.get(), "SELECT file_bytes FROM projects WHERE name=?1");
  statement.Bind(1, project);
  PLEAT_ASSIGN_OR_RETURN(const bool found, statement.Step("read"));
  return found ? static_cast<uint64_t>(statement.Int64(0)) : 0;
}

absl::StatusOr<std::vector<std::pair<std::string, uint64_t>>> Catalog::ListProjectBytes() {
  std::vector<std::pair<std::string, uint64_t>> projects;
  if (!has_projects_) return projects;
  std::lock_guard lock(reader_->mutex());
  Statement statement(reader_.get(), "SELECT name, file_bytes FROM projects ORDER BY name");
  while (true) {
    PLEAT_ASSIGN_OR_RETURN(const bool found, statement.Step("read"));
    if (!found) return projects;
    projects.emplace_back(statement.Bytes(0), static_cast<uint64_t>(statement.Int64(1)));
  }
}

absl::Status Catalog::NoteFileSize(const std::string& id, uint64_t file_bytes) {
  std::lock_guard lock(writer_->mutex());
  Statement statement(writer_.get(),
                      "UPDATE entries SET file_bytes=?2"
                      " WHERE id=?1 AND file_bytes=0 AND kind <> 'job'");
  statement.Bind(1, id);
  statement.Bind(2, static_cast<int64_t>(file_bytes));
  return statement.Step("change").status();
}

absl::StatusOr<std::vector<std::string>> Catalog::FilesWithoutSize() {
  return Ids("SELECT DISTINCT id FROM entries WHERE file_bytes=0 AND kind <> 'job' ORDER BY id");
}

absl::StatusOr<std::vector<CatalogEntry>> Catalog::ListExpired(EntryKind kind,
                                                               int64_t now_unix_ms) {
  if (!has_lives_) return std::vector<CatalogEntry>();
  std::lock_guard lock(reader_->mutex());
  Statement statement(
      reader_.get(),
      Select("WHERE expires_ms>0 AND expires_ms<=?2 AND kind=?1 AND pinned=0 ORDER BY position")
          .c_str());
  statement.Bind(1, EntryKindName(kind));
  statement.Bind(2, now_unix_ms);
  return ReadEntries(&statement);
}

absl::Status Catalog::Change(const char* sql, const ProjectKind& kind, const std::string& id,
                             std::optional<int64_t> value) {
  std::lock_guard lock(writer_->mutex());
  Statement statement(writer_.get(),
                      absl::StrCat(sql, " kind=?1 AND id=?2 AND project=?4").c_str());
  statement.Bind(1, EntryKindName(kind.kind));
  statement.Bind(2, id);
  statement.Bind(3, value.value_or(0));
  statement.Bind(4, kind.project);
  PLEAT_RETURN_IF_ERROR(statement.Step("change").status());
  if (sqlite3_changes(writer_->handle()) > 0) return absl::OkStatus();
  return NotThere(kind.kind, id);
}

absl::Status Catalog::Delete(const ProjectKind& kind, const std::string& id) {
  return Change("DELETE FROM entries WHERE", kind, id);
}

absl::Status Catalog::DeleteInAllProjects(const std::string& id) {
  std::lock_guard lock(writer_->mutex());
  Statement statement(writer_.get(), "DELETE FROM entries WHERE id=?1 AND kind <> 'job'");
  statement.Bind(1, id);
  return statement.Step("change").status();
}

absl::Status Catalog::DeleteExpired(const ProjectKind& kind, const std::string& id,
                                    int64_t now_unix_ms) {
  return Change("DELETE FROM entries WHERE pinned=0 AND expires_ms>0 AND expires_ms<=?3 AND", kind,
                id, now_unix_ms);
}

absl::Status Catalog::SetPinned(const ProjectKind& kind, const std::string& id, bool pinned) {
  return Change("UPDATE entries SET pinned=?3 WHERE", kind, id, pinned ? 1 : 0);
}

absl::Status Catalog::Prolong(const ProjectKind& kind, const std::string& id,
                              int64_t expires_unix_ms) {
  return Change(
      "UPDATE entries SET expires_ms="
      "CASE WHEN expires_ms=0 OR ?3=0 THEN 0 WHEN expires_ms<?3 THEN ?3 ELSE expires_ms END WHERE",
      kind, id, expires_unix_ms);
}

absl::StatusOr<std::vector<std::string>> Catalog::Ids(const char* sql) {
  std::lock_guard lock(reader_->mutex());
  Statement statement(reader_.get(), sql);
  std::vector<std::string> ids;
  while (true) {
    PLEAT_ASSIGN_OR_RETURN(const bool found, statement.Step("read"));
    if (!found) return ids;
    ids.push_back(statement.Bytes(0));
  }
}

absl::StatusOr<std::vector<std::string>> Catalog::FileIds() {
  return Ids("SELECT DISTINCT id FROM entries WHERE kind <> 'job' ORDER BY id");
}

absl::StatusOr<bool> Catalog::NamesFile(const std::string& id) {
  std::lock_guard lock(reader_->mutex());
  Statement statement(reader_.get(), "SELECT 1 FROM entries WHERE id=?1 AND kind <> 'job'");
  statement.Bind(1, id);
  return statement.Step("read");
}

absl::StatusOr<std::vector<std::string>> Catalog::PendingRemovals() {
  if (!has_properties_) return std::vector<std::string>();
  return Ids("SELECT id FROM removals ORDER BY id");
}

absl::Status Catalog::ForgetRemoval(const std::string& id) {
  std::lock_guard lock(writer_->mutex());
  // Nothing was promised that a power cut could break: the file would be removed once more.
  PLEAT_RETURN_IF_ERROR(writer_->Execute("PRAGMA synchronous=NORMAL"));
  absl::Status status;
  {
    Statement statement(writer_.get(), "DELETE FROM removals WHERE id=?1");
    statement.Bind(1, id);
    status = statement.Step("change").status();
  }
  const absl::Status full = writer_->Execute("PRAGMA synchronous=FULL");
  return status.ok() ? full : status;
}

absl::Status Catalog::CopyTo(const std::string& path) {
  PLEAT_ASSIGN_OR_RETURN(const std::unique_ptr<Database> copy,
                         Database::Open(path, Database::Access::kReadWrite));
  std::lock_guard lock(reader_->mutex());
  sqlite3_backup* backup = sqlite3_backup_init(copy->handle(), "main", reader_->handle(), "main");
  if (backup == nullptr) {
    return DatabaseError(copy->handle(), sqlite3_errcode(copy->handle()), "copy");
  }
  sqlite3_backup_step(backup, -1);
  const int code = sqlite3_backup_finish(backup);
  return code == SQLITE_OK ? absl::OkStatus() : DatabaseError(copy->handle(), code, "copy");
}

}  // namespace pleat
