#include "pleat/store/catalog.h"

#include <mutex>
#include <utility>

#include "absl/strings/str_cat.h"
#include "database.h"
#include "pleat/base/status.h"
#include "sync_hook_vfs.h"

namespace pleat {
namespace {

// Version 1 had no tables but `entries`. Version 2 had neither the indexes nor the last three
// columns of `entries`.
constexpr int kSchemaVersion = 3;

// The two triggers keep `removals` right whatever changes the rows: an entry that goes leaves the
// id of its file there in the same commit, and one that comes takes the id back.
constexpr char kSchema[] =
    "CREATE TABLE IF NOT EXISTS entries ("
    " position INTEGER PRIMARY KEY AUTOINCREMENT,"
    " kind TEXT NOT NULL,"
    " id TEXT NOT NULL,"
    " record BLOB NOT NULL,"
    " attempts INTEGER NOT NULL DEFAULT 0,"
    " UNIQUE (kind, id));"
    "ALTER TABLE entries ADD COLUMN created_ms INTEGER NOT NULL DEFAULT 0;"
    "ALTER TABLE entries ADD COLUMN expires_ms INTEGER NOT NULL DEFAULT 0;"
    "ALTER TABLE entries ADD COLUMN pinned INTEGER NOT NULL DEFAULT 0;"
    "CREATE INDEX entries_in_order ON entries (kind, position);"
    "CREATE INDEX entries_that_expire ON entries (expires_ms) WHERE expires_ms > 0;"
    "CREATE TABLE IF NOT EXISTS properties (name TEXT PRIMARY KEY, value TEXT NOT NULL);"
    "CREATE TABLE IF NOT EXISTS removals (id TEXT PRIMARY KEY) WITHOUT ROWID;"
    "CREATE TRIGGER IF NOT EXISTS entry_removed AFTER DELETE ON entries WHEN OLD.kind <> 'job'"
    " BEGIN INSERT OR IGNORE INTO removals VALUES (OLD.id); END;"
    "CREATE TRIGGER IF NOT EXISTS entry_added AFTER INSERT ON entries"
    " BEGIN DELETE FROM removals WHERE id = NEW.id; END;";

// The rows of a statement of Catalog::Select.
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
                       .position = statement->Int64(6)});
  }
}

absl::Status NotThere(EntryKind kind, const std::string& id) {
  return absl::NotFoundError(absl::StrCat("no ", EntryKindName(kind), " '", id, "'"));
}

}  // namespace

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
  if (version < kSchemaVersion) {
    PLEAT_RETURN_IF_ERROR(catalog->Upgrade());
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
  if (version <= kSchemaVersion) return version;
  return absl::FailedPreconditionError(absl::StrCat("the catalog '", path, "' has version ",
                                                    version, ", this program reads up to ",
                                                    kSchemaVersion, "; use a newer pleatd"));
}

absl::Status Catalog::Upgrade() {
  absl::Status status = writer_->Execute(
      absl::StrCat("BEGIN;", kSchema, "PRAGMA user_version=", kSchemaVersion, "; COMMIT"));
  if (!status.ok()) writer_->Execute("ROLLBACK").IgnoreError();
  return status;
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
  Statement statement(writer_.get(),
                      "INSERT INTO entries (kind, id, record, attempts, created_ms, expires_ms)"
                      " VALUES (?1, ?2, ?3, ?4, ?5, ?6)"
                      " ON CONFLICT (kind, id) DO UPDATE SET record=?3, attempts=?4, expires_ms="
                      "CASE WHEN expires_ms=0 OR ?6=0 THEN 0"
                      " WHEN expires_ms<?6 THEN ?6 ELSE expires_ms END");
  statement.Bind(1, EntryKindName(kind));
  statement.Bind(2, entry.id);
  statement.BindBlob(3, entry.record);
  statement.Bind(4, entry.attempts);
  statement.Bind(5, entry.created_unix_ms);
  statement.Bind(6, entry.expires_unix_ms);
  return statement.Step("write").status();
}

std::string Catalog::Select(const char* conditions) const {
  return absl::StrCat("SELECT id, record, attempts, ",
                      has_lives_ ? "created_ms, expires_ms, pinned" : "0, 0, 0",
                      ", position FROM entries ", conditions);
}

absl::StatusOr<CatalogEntry> Catalog::Get(EntryKind kind, const std::string& id) {
  std::lock_guard lock(reader_->mutex());
  Statement statement(reader_.get(), Select("WHERE kind=?1 AND id=?2").c_str());
  statement.Bind(1, EntryKindName(kind));
  statement.Bind(2, id);
  PLEAT_ASSIGN_OR_RETURN(std::vector<CatalogEntry> found, ReadEntries(&statement));
  if (found.empty()) return NotThere(kind, id);
  return std::move(found[0]);
}

absl::StatusOr<std::vector<CatalogEntry>> Catalog::List(EntryKind kind) {
  std::lock_guard lock(reader_->mutex());
  Statement statement(reader_.get(), Select("WHERE kind=?1 ORDER BY position").c_str());
  statement.Bind(1, EntryKindName(kind));
  return ReadEntries(&statement);
}

absl::StatusOr<std::vector<CatalogEntry>> Catalog::ListPage(EntryKind kind, int64_t after_position,
                                                            int max_entries) {
  std::lock_guard lock(reader_->mutex());
  Statement statement(reader_.get(),
                      Select("WHERE kind=?1 AND position>?2 ORDER BY position LIMIT ?3").c_str());
  statement.Bind(1, EntryKindName(kind));
  statement.Bind(2, after_position);
  statement.Bind(3, max_entries);
  PLEAT_ASSIGN_OR_RETURN(std::vector<CatalogEntry> entries, ReadEntries(&statement));
  num_page_steps_.fetch_add(static_cast<uint64_t>(statement.num_steps()),
                            std::memory_order_relaxed);
  return entries;
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

absl::Status Catalog::Change(const char* sql, EntryKind kind, const std::string& id,
                             std::optional<int64_t> value) {
  std::lock_guard lock(writer_->mutex());
  Statement statement(writer_.get(), sql);
  statement.Bind(1, EntryKindName(kind));
  statement.Bind(2, id);
  if (value) statement.Bind(3, *value);
  PLEAT_RETURN_IF_ERROR(statement.Step("change").status());
  if (sqlite3_changes(writer_->handle()) > 0) return absl::OkStatus();
  return NotThere(kind, id);
}

absl::Status Catalog::Delete(EntryKind kind, const std::string& id) {
  return Change("DELETE FROM entries WHERE kind=?1 AND id=?2", kind, id);
}

absl::Status Catalog::DeleteExpired(EntryKind kind, const std::string& id, int64_t now_unix_ms) {
  return Change(
      "DELETE FROM entries WHERE kind=?1 AND id=?2"
      " AND pinned=0 AND expires_ms>0 AND expires_ms<=?3",
      kind, id, now_unix_ms);
}

absl::Status Catalog::SetPinned(EntryKind kind, const std::string& id, bool pinned) {
  return Change("UPDATE entries SET pinned=?3 WHERE kind=?1 AND id=?2", kind, id, pinned ? 1 : 0);
}

absl::Status Catalog::Prolong(EntryKind kind, const std::string& id, int64_t expires_unix_ms) {
  return Change(
      "UPDATE entries SET expires_ms="
      "CASE WHEN expires_ms=0 OR ?3=0 THEN 0 WHEN expires_ms<?3 THEN ?3 ELSE expires_ms END"
      " WHERE kind=?1 AND id=?2",
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
