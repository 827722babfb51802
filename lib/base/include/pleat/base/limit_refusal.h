// A refusal for a limit tells its caller which limit that was and when to come again. It travels as
// a payload of the status, so that every layer can pass it on without knowing it; on the wire it
// becomes google.rpc.QuotaFailure and RetryInfo.
#pragma once

#include <optional>
#include <string>

#include "absl/status/status.h"
#include "absl/strings/string_view.h"
#include "absl/time/time.h"

namespace pleat {

// Whose limit it is: "server" (all callers share it), "client", or "project:NAME".
inline constexpr char kServerLimit[] = "server";
inline constexpr char kClientLimit[] = "client";

struct LimitRefusal {
  std::string subject = kServerLimit;
  std::string limit{};  // what the operator can set: "--max-queued-jobs-per-client"
  // How long to wait before the same call may succeed, a guess where nobody can know. None: it will
  // be refused however often it is tried, because it alone is above the limit.
  std::optional<absl::Duration> retry_after{};
};

// kResourceExhausted with `message`. Nothing has been done when it is returned, so the caller may
// always try again.
absl::Status RefuseForLimit(const LimitRefusal& refusal, absl::string_view message);

// What RefuseForLimit put into a status; nothing for all others.
std::optional<LimitRefusal> LimitRefusalOf(const absl::Status& status);

}  // namespace pleat
