#include "pleat/store/catalog.h"

#include <mutex>
#include <utility>

#include "absl/strings/str_cat.h"
#include "database.h"
#include "pleat/base/status.h"
#include "sync_hook_vfs.h"

namespace pleat {
namespace {

// Version 1 had no tables but `entries`.
constexpr int kSchemaVersion = 2;

// The two triggers keep `removals` right whatever changes the rows: an entry that goes leaves the
// id of its file there in the same commit, and one that comes takes the id back.
constexpr char kSchema[] =
    "BEGIN;"
    "CREATE TABLE IF NOT EXISTS entries ("
    " position INTEGER PRIMARY KEY AUTOINCREMENT,"
    " kind TEXT NOT NULL,"
    " id TEXT NOT NULL,"
    " record BLOB NOT NULL,"
    " attempts INTEGER NOT NULL DEFAULT 0,"
    " UNIQUE (kind, id));"
    "CREATE TABLE IF NOT EXISTS properties (name TEXT PRIMARY KEY, value TEXT NOT NULL);"
    "CREATE TABLE IF NOT EXISTS removals (id TEXT PRIMARY KEY) WITHOUT ROWID;"
    "CREATE TRIGGER IF NOT EXISTS entry_removed AFTER DELETE ON entries WHEN OLD.kind <> 'job'"
    " BEGIN INSERT OR IGNORE INTO removals VALUES (OLD.id); END;"
    "CREATE TRIGGER IF NOT EXISTS entry_added AFTER INSERT ON entries"
    " BEGIN DELETE FROM removals WHERE id = NEW.id; END;";

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
    PLEAT_RETURN_IF_ERROR(catalog->writer_->Execute(
        absl::StrCat(kSchema, "PRAGMA user_version=", kSchemaVersion, "; COMMIT")));
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
                      "INSERT INTO entries (kind, id, record, attempts) VALUES (?1, ?2, ?3, ?4) "
                      "ON CONFLICT (kind, id) DO UPDATE SET record=?3, attempts=?4");
  statement.Bind(1, EntryKindName(kind));
  statement.Bind(2, entry.id);
  statement.BindBlob(3, entry.record);
  statement.Bind(4, entry.attempts);
  return statement.Step("write").status();
}

absl::StatusOr<CatalogEntry> Catalog::Get(EntryKind kind, const std::string& id) {
  std::lock_guard lock(reader_->mutex());
  Statement statement(reader_.get(),
                      "SELECT record, attempts FROM entries WHERE kind=?1 AND id=?2");
  statement.Bind(1, EntryKindName(kind));
  statement.Bind(2, id);
  PLEAT_ASSIGN_OR_RETURN(const bool found, statement.Step("read"));
  if (!found) return NotThere(kind, id);
  return CatalogEntry{id, statement.Bytes(0), statement.Int(1)};
}

absl::StatusOr<std::vector<CatalogEntry>> Catalog::List(EntryKind kind) {
  std::lock_guard lock(reader_->mutex());
  Statement statement(reader_.get(),
                      "SELECT id, record, attempts FROM entries WHERE kind=?1 ORDER BY position");
  statement.Bind(1, EntryKindName(kind));
  std::vector<CatalogEntry> entries;
  while (true) {
    PLEAT_ASSIGN_OR_RETURN(const bool found, statement.Step("read"));
    if (!found) return entries;
    entries.push_back({statement.Bytes(0), statement.Bytes(1), statement.Int(2)});
  }
}

absl::Status Catalog::Delete(EntryKind kind, const std::string& id) {
  std::lock_guard lock(writer_->mutex());
  Statement statement(writer_.get(), "DELETE FROM entries WHERE kind=?1 AND id=?2");
  statement.Bind(1, EntryKindName(kind));
  statement.Bind(2, id);
  PLEAT_RETURN_IF_ERROR(statement.Step("change").status());
  if (sqlite3_changes(writer_->handle()) > 0) return absl::OkStatus();
  return NotThere(kind, id);
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
