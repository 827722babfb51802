#include "call_observers.h"

#include <spdlog/spdlog.h>

#include <string>

#include "absl/status/status.h"
#include "absl/time/time.h"
#include "pleat/base/wall_clock.h"

namespace pleat {
namespace {

constexpr int kWarningDays = 30;

int64_t UnixSeconds() { return absl::ToUnixSeconds(SystemTime()); }
int64_t UnixMillis() { return absl::ToUnixMillis(SystemTime()); }

void Audit(const CallFacts& facts, absl::StatusCode status, double seconds, TokenRegistry* tokens,
           AuditLog* audit_log) {
  AuditEntry entry{.rpc = facts.method.substr(facts.method.rfind('/') + 1),
                   .peer = facts.peer,
                   .token_id = facts.token_id,
                   .project = facts.project,
                   .ids = facts.ids,
                   .trace_id = facts.trace_id,
                   .request_id = facts.request_id,
                   .status = absl::StatusCodeToString(status),
                   .seconds = seconds};
  // Whoever was not let in may have shown an id of somebody else.
  if (status != absl::StatusCode::kUnauthenticated) {
    entry.token_name = tokens->NameOf(facts.token_id);
  }
  if (const absl::Status written = audit_log->Write(entry); !written.ok()) {
    spdlog::error("{}", std::string(written.message()));
  }
}

void LogSlowCall(const CallFacts& facts, double seconds) {
  spdlog::warn("{} took {:.3f} s (from {}{}{})", facts.method, seconds, facts.peer,
               facts.trace_id.empty() ? "" : ", trace ", facts.trace_id);
}

}  // namespace

absl::StatusOr<std::unique_ptr<TokenRegistry>> OpenTokens(const std::string& path) {
  return TokenRegistry::Open(
      {.path = path, .clock = &UnixSeconds, .on_problem = [](const std::string& problem) {
         spdlog::error("{}", problem);
       }});
}

absl::StatusOr<std::unique_ptr<AuditLog>> OpenAuditLog(const std::string& path) {
  if (path.empty()) return std::unique_ptr<AuditLog>();
  return AuditLog::Open(path, &UnixMillis);
}

CallListener ObserveCalls(ServerMetrics* metrics, AuditLog* audit_log, TokenRegistry* tokens,
                          double slow_call_seconds) {
  return {[metrics](const std::string& method) { metrics->CallStarted(method); },
          [=](const CallFacts& facts, int code, double seconds) {
            const auto status = static_cast<absl::StatusCode>(code);
            metrics->CallEnded(facts.method, absl::StatusCodeToString(status), seconds);
            metrics->CallOfProject(facts.project);
            if (!facts.limit.empty()) metrics->CallRefused(facts.limit);
            if (!facts.is_stream && seconds > slow_call_seconds) LogSlowCall(facts, seconds);
            const bool refused = status == absl::StatusCode::kUnauthenticated ||
                                 status == absl::StatusCode::kPermissionDenied;
            if (audit_log != nullptr && (facts.audited || refused)) {
              Audit(facts, status, seconds, tokens, audit_log);
            }
          },
          [metrics](const char* step, double seconds) { metrics->FrameStep(step, seconds); }};
}

void LogJob(const JobInfo& job) {
  const bool failed = job.state == JobState::kFailed;
  spdlog::log(failed ? spdlog::level::warn : spdlog::level::info,
              "{} '{}' is {}{}{} [project {}{}{}]", job.id, job.name, JobStateName(job.state),
              job.error.ok() ? "" : ": ", std::string(job.error.message()), job.project,
              job.request_id.empty() ? "" : ", created as ", job.request_id);
}

void WarnBeforeExpiry(std::optional<int64_t> certificate_expiry) {
  if (!certificate_expiry) return;
  const int64_t days = (*certificate_expiry - UnixSeconds()) / (24 * 3600);
  if (days < kWarningDays) spdlog::warn("the TLS certificate expires in {} days", days);
}

}  // namespace pleat
