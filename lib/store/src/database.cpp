#include "database.h"

#include "absl/strings/str_cat.h"

namespace pleat {
namespace {

constexpr int kBusyTimeoutMs = 5000;

}  // namespace

absl::Status DatabaseError(sqlite3* database, int code, absl::string_view action) {
  const std::string text =
      absl::StrCat("cannot ", action, " the catalog: ", sqlite3_errmsg(database));
  switch (code & 0xff) {  // the rest says more about the same fault
    case SQLITE_FULL:
      return absl::ResourceExhaustedError(text);
    case SQLITE_CORRUPT:
    case SQLITE_NOTADB:
      return absl::DataLossError(text);
    case SQLITE_BUSY:
    case SQLITE_LOCKED:
      return absl::UnavailableError(text);
    case SQLITE_READONLY:
    case SQLITE_CANTOPEN:
    case SQLITE_PERM:
      return absl::FailedPreconditionError(text);
    default:
      return absl::InternalError(text);
  }
}

absl::StatusOr<std::unique_ptr<Database>> Database::Open(const std::string& path, Access access,
                                                         const char* vfs) {
  const int flags = access == Access::kReadOnly ? SQLITE_OPEN_READONLY
                                                : SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE;
  sqlite3* handle = nullptr;
  const int code = sqlite3_open_v2(path.c_str(), &handle, flags | SQLITE_OPEN_FULLMUTEX, vfs);
  std::unique_ptr<Database> database(new Database(handle));
  if (code != SQLITE_OK) return DatabaseError(handle, code, absl::StrCat("open '", path, "',"));
  sqlite3_busy_timeout(handle, kBusyTimeoutMs);
  return database;
}

absl::Status Database::Execute(const std::string& sql) {
  const int code = sqlite3_exec(database_, sql.c_str(), nullptr, nullptr, nullptr);
  return code == SQLITE_OK ? absl::OkStatus() : DatabaseError(database_, code, "prepare");
}

Statement::Statement(Database* database, const char* sql)
    : owner_(database),
      database_(database->handle()),
      code_(sqlite3_prepare_v2(database_, sql, -1, &statement_, nullptr)) {}

Statement::~Statement() {
  if (statement_ == nullptr) return;
  const int steps = sqlite3_stmt_status(statement_, SQLITE_STMTSTATUS_VM_STEP, 0);
  owner_->num_steps_.fetch_add(static_cast<uint64_t>(steps), std::memory_order_relaxed);
  sqlite3_finalize(statement_);
}

void Statement::Bind(int index, const std::string& text) {
  if (code_ != SQLITE_OK) return;
  code_ = sqlite3_bind_text64(statement_, index, text.data(), text.size(), SQLITE_TRANSIENT,
                              SQLITE_UTF8);
}

void Statement::BindBlob(int index, const std::string& bytes) {
  if (code_ != SQLITE_OK) return;
  code_ = sqlite3_bind_blob64(statement_, index, bytes.data(), bytes.size(), SQLITE_TRANSIENT);
}

void Statement::Bind(int index, int64_t value) {
  if (code_ == SQLITE_OK) code_ = sqlite3_bind_int64(statement_, index, value);
}

absl::StatusOr<bool> Statement::Step(absl::string_view action) {
  if (code_ != SQLITE_OK) return DatabaseError(database_, code_, action);
  const int code = sqlite3_step(statement_);
  if (code == SQLITE_ROW) return true;
  if (code == SQLITE_DONE) return false;
  return DatabaseError(database_, code, action);
}

std::string Statement::Bytes(int column) {
  const void* data = sqlite3_column_blob(statement_, column);
  const int size = sqlite3_column_bytes(statement_, column);
  return data == nullptr ? std::string() : std::string(static_cast<const char*>(data), size);
}

}  // namespace pleat
