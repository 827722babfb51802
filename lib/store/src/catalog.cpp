#include "pleat/store/catalog.h"

#include <sqlite3.h>

#include <mutex>
#include <utility>

#include "absl/strings/str_cat.h"
#include "pleat/base/status.h"
#include "sync_hook_vfs.h"

namespace pleat {
namespace {

constexpr int kSchemaVersion = 1;
constexpr int kBusyTimeoutMs = 5000;

const char* KindName(EntryKind kind) {
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

// `code` is the result of a call on `database`, which also has the words for it.
absl::Status DatabaseError(sqlite3* database, int code, absl::string_view action) {
  const std::string text =
      absl::StrCat("cannot ", action, " the catalog: ", sqlite3_errmsg(database));
  switch (code) {
    case SQLITE_FULL:
      return absl::ResourceExhaustedError(text);
    case SQLITE_CORRUPT:
    case SQLITE_NOTADB:
      return absl::DataLossError(text);
    case SQLITE_BUSY:
    case SQLITE_LOCKED:
      return absl::UnavailableError(text);
    default:
      return absl::InternalError(text);
  }
}

}  // namespace

// One open database with the mutex of its user.
class Catalog::Connection {
 public:
  static absl::StatusOr<std::unique_ptr<Connection>> Open(const std::string& path,
                                                          const char* vfs) {
    sqlite3* database = nullptr;
    const int code =
        sqlite3_open_v2(path.c_str(), &database,
                        SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE | SQLITE_OPEN_FULLMUTEX, vfs);
    std::unique_ptr<Connection> connection(new Connection(database));
    if (code != SQLITE_OK) {
      return DatabaseError(database, code, absl::StrCat("open '", path, "',"));
    }
    sqlite3_busy_timeout(database, kBusyTimeoutMs);
    return connection;
  }
  ~Connection() { sqlite3_close(database_); }
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;

  std::mutex& mutex() { return mutex_; }
  sqlite3* database() { return database_; }  // call with mutex() held

  absl::Status Execute(const char* sql) {
    const int code = sqlite3_exec(database_, sql, nullptr, nullptr, nullptr);
    return code == SQLITE_OK ? absl::OkStatus() : DatabaseError(database_, code, "prepare");
  }

 private:
  explicit Connection(sqlite3* database) : database_(database) {}

  std::mutex mutex_;
  sqlite3* database_;
};

// One prepared statement with its bound values. The first call that fails, be it preparing or
// binding, decides what Step returns, so callers check in one place.
class Catalog::Statement {
 public:
  Statement(Connection* connection, const char* sql)
      : database_(connection->database()),
        code_(sqlite3_prepare_v2(database_, sql, -1, &statement_, nullptr)) {}
  ~Statement() { sqlite3_finalize(statement_); }
  Statement(const Statement&) = delete;
  Statement& operator=(const Statement&) = delete;

  void Bind(int index, const std::string& text) {
    if (code_ != SQLITE_OK) return;
    code_ = sqlite3_bind_text64(statement_, index, text.data(), text.size(), SQLITE_TRANSIENT,
                                SQLITE_UTF8);
  }
  void BindBlob(int index, const std::string& bytes) {
    if (code_ != SQLITE_OK) return;
    code_ = sqlite3_bind_blob64(statement_, index, bytes.data(), bytes.size(), SQLITE_TRANSIENT);
  }
  void Bind(int index, int value) {
    if (code_ == SQLITE_OK) code_ = sqlite3_bind_int(statement_, index, value);
  }

  // True when there is a row.
  absl::StatusOr<bool> Step(absl::string_view action) {
    if (code_ != SQLITE_OK) return DatabaseError(database_, code_, action);
    const int code = sqlite3_step(statement_);
    if (code == SQLITE_ROW) return true;
    if (code == SQLITE_DONE) return false;
    return DatabaseError(database_, code, action);
  }
  std::string Bytes(int column) {
    const void* data = sqlite3_column_blob(statement_, column);
    const int size = sqlite3_column_bytes(statement_, column);
    return data == nullptr ? std::string() : std::string(static_cast<const char*>(data), size);
  }
  int Int(int column) { return sqlite3_column_int(statement_, column); }

 private:
  sqlite3* database_;
  sqlite3_stmt* statement_ = nullptr;
  int code_;
};

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
  PLEAT_ASSIGN_OR_RETURN(catalog->writer_, Connection::Open(path, vfs));
  PLEAT_RETURN_IF_ERROR(catalog->Prepare(path));
  PLEAT_ASSIGN_OR_RETURN(catalog->reader_, Connection::Open(path, vfs));
  PLEAT_RETURN_IF_ERROR(catalog->reader_->Execute("PRAGMA query_only=ON"));
  return catalog;
}

absl::Status Catalog::Prepare(const std::string& path) {
  PLEAT_RETURN_IF_ERROR(writer_->Execute("PRAGMA journal_mode=WAL"));
  PLEAT_RETURN_IF_ERROR(writer_->Execute("PRAGMA synchronous=FULL"));
  {
    Statement check(writer_.get(), "PRAGMA quick_check(1)");
    PLEAT_ASSIGN_OR_RETURN(const bool row, check.Step("check"));
    if (!row || check.Bytes(0) != "ok") {
      return absl::DataLossError(absl::StrCat("the catalog '", path,
                                              "' is damaged: ", row ? check.Bytes(0) : "no answer",
                                              "; restore it from a backup"));
    }
  }
  int version = 0;
  {
    Statement query(writer_.get(), "PRAGMA user_version");
    PLEAT_ASSIGN_OR_RETURN(const bool row, query.Step("read"));
    if (row) version = query.Int(0);
  }
  if (version > kSchemaVersion) {
    return absl::FailedPreconditionError(absl::StrCat("the catalog '", path, "' has version ",
                                                      version, ", this program reads up to ",
                                                      kSchemaVersion, "; use a newer pleatd"));
  }
  PLEAT_RETURN_IF_ERROR(
      writer_->Execute("CREATE TABLE IF NOT EXISTS entries ("
                       " position INTEGER PRIMARY KEY AUTOINCREMENT,"
                       " kind TEXT NOT NULL,"
                       " id TEXT NOT NULL,"
                       " record BLOB NOT NULL,"
                       " attempts INTEGER NOT NULL DEFAULT 0,"
                       " UNIQUE (kind, id))"));
  return writer_->Execute(absl::StrCat("PRAGMA user_version=", kSchemaVersion).c_str());
}

absl::Status Catalog::Put(EntryKind kind, const CatalogEntry& entry) {
  std::lock_guard lock(writer_->mutex());
  Statement statement(writer_.get(),
                      "INSERT INTO entries (kind, id, record, attempts) VALUES (?1, ?2, ?3, ?4) "
                      "ON CONFLICT (kind, id) DO UPDATE SET record=?3, attempts=?4");
  statement.Bind(1, KindName(kind));
  statement.Bind(2, entry.id);
  statement.BindBlob(3, entry.record);
  statement.Bind(4, entry.attempts);
  return statement.Step("write").status();
}

absl::StatusOr<CatalogEntry> Catalog::Get(EntryKind kind, const std::string& id) {
  std::lock_guard lock(reader_->mutex());
  Statement statement(reader_.get(),
                      "SELECT record, attempts FROM entries WHERE kind=?1 AND id=?2");
  statement.Bind(1, KindName(kind));
  statement.Bind(2, id);
  PLEAT_ASSIGN_OR_RETURN(const bool found, statement.Step("read"));
  if (!found) return absl::NotFoundError(absl::StrCat("no ", KindName(kind), " '", id, "'"));
  return CatalogEntry{id, statement.Bytes(0), statement.Int(1)};
}

absl::StatusOr<std::vector<CatalogEntry>> Catalog::List(EntryKind kind) {
  std::lock_guard lock(reader_->mutex());
  Statement statement(reader_.get(),
                      "SELECT id, record, attempts FROM entries WHERE kind=?1 ORDER BY position");
  statement.Bind(1, KindName(kind));
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
  statement.Bind(1, KindName(kind));
  statement.Bind(2, id);
  PLEAT_RETURN_IF_ERROR(statement.Step("change").status());
  if (sqlite3_changes(writer_->database()) > 0) return absl::OkStatus();
  return absl::NotFoundError(absl::StrCat("no ", KindName(kind), " '", id, "'"));
}

}  // namespace pleat
