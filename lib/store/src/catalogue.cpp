#include "pleat/store/catalogue.h"

#include <sqlite3.h>

#include <utility>

#include "absl/strings/str_cat.h"
#include "pleat/base/status.h"

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

absl::Status DatabaseError(sqlite3* database, absl::string_view action) {
  const int code = sqlite3_errcode(database);
  const std::string text =
      absl::StrCat("cannot ", action, " the catalogue: ", sqlite3_errmsg(database));
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

// One prepared statement with its bound values.
class Catalogue::Statement {
 public:
  Statement(sqlite3* database, const char* sql) : database_(database) {
    sqlite3_prepare_v2(database, sql, -1, &statement_, nullptr);
  }
  ~Statement() { sqlite3_finalize(statement_); }
  Statement(const Statement&) = delete;
  Statement& operator=(const Statement&) = delete;

  void Bind(int index, const std::string& text) {
    sqlite3_bind_text64(statement_, index, text.data(), text.size(), SQLITE_TRANSIENT, SQLITE_UTF8);
  }
  void BindBlob(int index, const std::string& bytes) {
    sqlite3_bind_blob64(statement_, index, bytes.data(), bytes.size(), SQLITE_TRANSIENT);
  }
  void Bind(int index, int value) { sqlite3_bind_int(statement_, index, value); }

  // True when there is a row.
  absl::StatusOr<bool> Step(absl::string_view action) {
    if (statement_ == nullptr) return DatabaseError(database_, action);
    const int code = sqlite3_step(statement_);
    if (code == SQLITE_ROW) return true;
    if (code == SQLITE_DONE) return false;
    return DatabaseError(database_, action);
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
};

absl::StatusOr<std::unique_ptr<Catalogue>> Catalogue::Open(const std::string& path) {
  sqlite3* database = nullptr;
  const int code =
      sqlite3_open_v2(path.c_str(), &database,
                      SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE | SQLITE_OPEN_FULLMUTEX, nullptr);
  std::unique_ptr<Catalogue> catalogue(new Catalogue(database));
  if (code != SQLITE_OK) return DatabaseError(database, absl::StrCat("open '", path, "',"));
  PLEAT_RETURN_IF_ERROR(catalogue->Prepare(path));
  return catalogue;
}

absl::Status Catalogue::Prepare(const std::string& path) {
  sqlite3_busy_timeout(database_, kBusyTimeoutMs);
  PLEAT_RETURN_IF_ERROR(Execute("PRAGMA journal_mode=WAL"));
  PLEAT_RETURN_IF_ERROR(Execute("PRAGMA synchronous=FULL"));
  {
    Statement check(database_, "PRAGMA quick_check(1)");
    PLEAT_ASSIGN_OR_RETURN(const bool row, check.Step("check"));
    if (!row || check.Bytes(0) != "ok") {
      return absl::DataLossError(absl::StrCat("the catalogue '", path,
                                              "' is damaged: ", row ? check.Bytes(0) : "no answer",
                                              "; restore it from a backup"));
    }
  }
  int version = 0;
  {
    Statement query(database_, "PRAGMA user_version");
    PLEAT_ASSIGN_OR_RETURN(const bool row, query.Step("read"));
    if (row) version = query.Int(0);
  }
  if (version > kSchemaVersion) {
    return absl::FailedPreconditionError(absl::StrCat("the catalogue '", path, "' has version ",
                                                      version, ", this program reads up to ",
                                                      kSchemaVersion, "; use a newer pleatd"));
  }
  PLEAT_RETURN_IF_ERROR(
      Execute("CREATE TABLE IF NOT EXISTS entries ("
              " position INTEGER PRIMARY KEY AUTOINCREMENT,"
              " kind TEXT NOT NULL,"
              " id TEXT NOT NULL,"
              " record BLOB NOT NULL,"
              " attempts INTEGER NOT NULL DEFAULT 0,"
              " UNIQUE (kind, id))"));
  return Execute(absl::StrCat("PRAGMA user_version=", kSchemaVersion).c_str());
}

Catalogue::~Catalogue() { sqlite3_close(database_); }

absl::Status Catalogue::Execute(const char* sql) {
  if (sqlite3_exec(database_, sql, nullptr, nullptr, nullptr) == SQLITE_OK) {
    return absl::OkStatus();
  }
  return DatabaseError(database_, "prepare");
}

absl::Status Catalogue::Put(EntryKind kind, const CatalogueEntry& entry) {
  std::lock_guard lock(mutex_);
  Statement statement(database_,
                      "INSERT INTO entries (kind, id, record, attempts) VALUES (?1, ?2, ?3, ?4) "
                      "ON CONFLICT (kind, id) DO UPDATE SET record=?3, attempts=?4");
  statement.Bind(1, KindName(kind));
  statement.Bind(2, entry.id);
  statement.BindBlob(3, entry.record);
  statement.Bind(4, entry.attempts);
  return statement.Step("write").status();
}

absl::StatusOr<CatalogueEntry> Catalogue::Get(EntryKind kind, const std::string& id) {
  std::lock_guard lock(mutex_);
  Statement statement(database_, "SELECT record, attempts FROM entries WHERE kind=?1 AND id=?2");
  statement.Bind(1, KindName(kind));
  statement.Bind(2, id);
  PLEAT_ASSIGN_OR_RETURN(const bool found, statement.Step("read"));
  if (!found) return absl::NotFoundError(absl::StrCat("no ", KindName(kind), " '", id, "'"));
  return CatalogueEntry{id, statement.Bytes(0), statement.Int(1)};
}

absl::StatusOr<std::vector<CatalogueEntry>> Catalogue::List(EntryKind kind) {
  std::lock_guard lock(mutex_);
  Statement statement(database_,
                      "SELECT id, record, attempts FROM entries WHERE kind=?1 ORDER BY position");
  statement.Bind(1, KindName(kind));
  std::vector<CatalogueEntry> entries;
  while (true) {
    PLEAT_ASSIGN_OR_RETURN(const bool found, statement.Step("read"));
    if (!found) return entries;
    entries.push_back({statement.Bytes(0), statement.Bytes(1), statement.Int(2)});
  }
}

absl::Status Catalogue::Delete(EntryKind kind, const std::string& id) {
  std::lock_guard lock(mutex_);
  Statement statement(database_, "DELETE FROM entries WHERE kind=?1 AND id=?2");
  statement.Bind(1, KindName(kind));
  statement.Bind(2, id);
  PLEAT_RETURN_IF_ERROR(statement.Step("change").status());
  if (sqlite3_changes(database_) > 0) return absl::OkStatus();
  return absl::NotFoundError(absl::StrCat("no ", KindName(kind), " '", id, "'"));
}

}  // namespace pleat
