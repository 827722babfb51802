#include "pleat/observe/audit_log.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <nlohmann/json.hpp>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/time/time.h"
#include "pleat/base/status.h"

namespace pleat {
namespace {

using nlohmann::ordered_json;

std::string TimeText(int64_t unix_ms) {
  return absl::FormatTime("%Y-%m-%dT%H:%M:%E3SZ", absl::FromUnixMillis(unix_ms),
                          absl::UTCTimeZone());
}

std::string Line(const AuditEntry& entry, int64_t unix_ms) {
  ordered_json line{{"time", TimeText(unix_ms)}, {"rpc", entry.rpc}, {"peer", entry.peer}};
  if (!entry.token_id.empty()) line["token"] = entry.token_id;
  if (!entry.token_name.empty()) line["name"] = entry.token_name;
  if (!entry.project.empty()) line["project"] = entry.project;
  if (!entry.ids.empty()) line["ids"] = entry.ids;
  if (!entry.trace_id.empty()) line["trace"] = entry.trace_id;
  if (!entry.request_id.empty()) line["request"] = entry.request_id;
  line["status"] = entry.status;
  line["seconds"] = entry.seconds;
  // Ids come from outside: bytes that are no UTF-8 are replaced.
  return line.dump(-1, ' ', /*ensure_ascii=*/true, ordered_json::error_handler_t::replace) + "\n";
}

}  // namespace

absl::StatusOr<std::unique_ptr<AuditLog>> AuditLog::Open(const std::string& path,
                                                         std::function<int64_t()> clock) {
  const int fd = open(path.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0600);
  if (fd < 0) {
    return ErrnoStatus(errno, absl::StrCat("cannot open the audit log '", path, "'"));
  }
  return std::unique_ptr<AuditLog>(new AuditLog(fd, std::move(clock)));
}

AuditLog::~AuditLog() { close(fd_); }

absl::Status AuditLog::Write(const AuditEntry& entry) {
  const std::string line = Line(entry, clock_());
  const ssize_t written = write(fd_, line.data(), line.size());
  if (written == static_cast<ssize_t>(line.size())) return absl::OkStatus();
  return ErrnoStatus(written < 0 ? errno : ENOSPC, "cannot write to the audit log");
}

}  // namespace pleat
