// A thin layer over SQLite: an open database, and one prepared statement.
#pragma once

#include <sqlite3.h>

#include <atomic>
#include <cstdint>
#include <memory>
#include <mutex>
#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"

namespace pleat {

// The error of a call on `database` that ended with `code`: kResourceExhausted on a full disk,
// kDataLoss when the file is damaged, kUnavailable when another connection holds it, and
// kFailedPrecondition when it cannot be written. The words are SQLite's and name no path.
absl::Status DatabaseError(sqlite3* database, int code, absl::string_view action);

// One open database with the mutex of its user.
class Database {
 public:
  enum class Access { kReadWrite, kReadOnly };

  // vfs: the name of SQLite's file layer, null for the default one. A missing file is created
  // unless it is to be read only.
  static absl::StatusOr<std::unique_ptr<Database>> Open(const std::string& path, Access access,
                                                        const char* vfs = nullptr);
  ~Database() { sqlite3_close(database_); }
  Database(const Database&) = delete;
  Database& operator=(const Database&) = delete;

  std::mutex& mutex() { return mutex_; }
  sqlite3* handle() { return database_; }  // call with mutex() held

  // Runs statements that give no rows.
  absl::Status Execute(const std::string& sql);

  // The steps that SQLite's machine has taken for all statements that are over: what they cost,
  // without a clock.
  uint64_t num_steps() const { return num_steps_.load(std::memory_order_relaxed); }

 private:
  explicit Database(sqlite3* database) : database_(database) {}

  friend class Statement;

  std::mutex mutex_;
  sqlite3* database_;
  std::atomic<uint64_t> num_steps_ = 0;
};

// One prepared statement with its bound values. The first call that fails, be it preparing or
// binding, decides what Step returns, so callers check in one place.
class Statement {
 public:
  Statement(Database* database, const char* sql);
  ~Statement();
  Statement(const Statement&) = delete;
  Statement& operator=(const Statement&) = delete;

  // index: from 1, as in the text of the statement.
  void Bind(int index, const std::string& text);
  void BindBlob(int index, const std::string& bytes);
  void Bind(int index, int64_t value);

  // True when there is a row.
  absl::StatusOr<bool> Step(absl::string_view action);
  // These read a column of the current row, counted from 0.
  std::string Bytes(int column);
  int Int(int column) { return sqlite3_column_int(statement_, column); }
  int64_t Int64(int column) { return sqlite3_column_int64(statement_, column); }

 private:
  Database* const owner_;
  sqlite3* database_;
  sqlite3_stmt* statement_ = nullptr;
  int code_;
};

}  // namespace pleat
