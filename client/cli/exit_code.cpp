#include "cli/exit_code.h"

#include <string>

#include "absl/strings/cord.h"

namespace pleat {
namespace {
constexpr char kUsagePayload[] = "pleat/usage";
}  // namespace

ExitCode ExitCodeOf(const absl::Status& status) {
  if (IsUsageError(status)) return ExitCode::kUsage;
  switch (status.code()) {
    case absl::StatusCode::kOk:
      return ExitCode::kOk;
    case absl::StatusCode::kInvalidArgument:
    case absl::StatusCode::kDataLoss:
    case absl::StatusCode::kOutOfRange:
      return ExitCode::kBadInput;
    case absl::StatusCode::kNotFound:
      return ExitCode::kNotFound;
    case absl::StatusCode::kFailedPrecondition:
    case absl::StatusCode::kPermissionDenied:
    case absl::StatusCode::kUnauthenticated:
    case absl::StatusCode::kAlreadyExists:
    case absl::StatusCode::kAborted:
    case absl::StatusCode::kUnimplemented:  // an older server, or a file system that cannot
      return ExitCode::kRefused;
    case absl::StatusCode::kUnavailable:
    case absl::StatusCode::kDeadlineExceeded:
      return ExitCode::kUnavailable;
    case absl::StatusCode::kCancelled:
      return ExitCode::kCancelled;
    case absl::StatusCode::kResourceExhausted:
      return ExitCode::kLimit;
    default:
      return ExitCode::kInternal;
  }
}

absl::Status UsageError(const std::string& message) {
  absl::Status status = absl::InvalidArgumentError(message);
  status.SetPayload(kUsagePayload, absl::Cord());
  return status;
}

bool IsUsageError(const absl::Status& status) {
  return status.GetPayload(kUsagePayload).has_value();
}

const char* ExitCodeHelp() {
  return "Exit codes:\n"
         "  0  done\n"
         "  1  internal fault\n"
         "  2  wrong command line\n"
         "  3  bad input (file, frame and reason on stderr)\n"
         "  4  not found\n"
         "  5  refused (no human-like rig, job failed, object in use)\n"
         "  6  server unreachable or too late\n"
         "  7  cancelled (Ctrl-C)\n"
         "  8  over a limit (size, memory, disk)\n";
}

}  // namespace pleat
