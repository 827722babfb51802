// What the program does beside each call: metrics, the audit log, and the tokens behind it.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "absl/status/statusor.h"
#include "pleat/grpc/grpc_server.h"
#include "pleat/identity/token_registry.h"
#include "pleat/metrics/server_metrics.h"
#include "pleat/observe/audit_log.h"
#include "pleat/service/job_service.h"

namespace pleat {

// Both read the system's clock and log what goes wrong later. An empty path means no audit log, and
// gives null.
absl::StatusOr<std::unique_ptr<TokenRegistry>> OpenTokens(const std::string& path);
absl::StatusOr<std::unique_ptr<AuditLog>> OpenAuditLog(const std::string& path);

// Counts each call, and writes a line to the audit log when the call belongs there or was refused.
// A call that is no stream and takes longer than `slow_call_seconds` is a warning in the log.
// `audit_log` may be null. All must outlive the server.
CallListener ObserveCalls(ServerMetrics* metrics, AuditLog* audit_log, TokenRegistry* tokens,
                          double slow_call_seconds);

// Logs what a job has come to.
void LogJob(const JobInfo& job);

// Logs a warning when a certificate expires within the next month.
void WarnBeforeExpiry(std::optional<int64_t> certificate_expiry);

}  // namespace pleat
