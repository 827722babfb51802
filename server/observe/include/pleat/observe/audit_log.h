// Who did what, when, from where, and how it ended: a file that only grows.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "absl/status/statusor.h"

namespace pleat {

struct AuditEntry {
  std::string rpc{};   // "DeleteModel"
  std::string peer{};  // "ipv4:10.0.0.7:52114"
  // The token that the call showed. Its name is empty where the server does not know the token:
  // then anybody may have written the id.
  std::string token_id{}, token_name{};
  std::string project{};           // that the caller was let into; empty: none
  std::vector<std::string> ids{};  // what the request names
  std::string trace_id{};          // W3C; empty: none
  std::string request_id{};        // that the lines of the log about the call name
  std::string status{};            // "OK", "NOT_FOUND", ...
  double seconds = 0;              // from the begin of the call to its end
};

// One JSON object per line (docs/security.md). Each line is one write to a file that was opened for
// appending: lines of several threads and processes do not mix, and a program that rotates logs may
// copy and truncate the file. Thread-safe.
class AuditLog {
 public:
  // Makes the file when it is missing; only its owner can read it. `clock` gives Unix milliseconds.
  static absl::StatusOr<std::unique_ptr<AuditLog>> Open(const std::string& path,
                                                        std::function<int64_t()> clock);
  ~AuditLog();
  AuditLog(const AuditLog&) = delete;
  AuditLog& operator=(const AuditLog&) = delete;

  // An error says that the line is not in the file.
  absl::Status Write(const AuditEntry& entry);

 private:
  AuditLog(int fd, std::function<int64_t()> clock) : fd_(fd), clock_(std::move(clock)) {}

  const int fd_;
  const std::function<int64_t()> clock_;
};

}  // namespace pleat
