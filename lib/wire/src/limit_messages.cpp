#include "pleat/wire/limit_messages.h"

#include <algorithm>
#include <optional>

#include "absl/time/time.h"
#include "google/rpc/error_details.pb.h"
#include "google/rpc/status.pb.h"
#include "pleat/base/limit_refusal.h"
#include "pleat/base/utf8.h"

namespace pleat {
namespace {

// A server that asks for more has a clock or a mind of its own.
constexpr absl::Duration kMaxDelay = absl::Hours(24);

absl::Duration DelayOf(const google::rpc::RetryInfo& info) {
  const absl::Duration delay =
      absl::Seconds(info.retry_delay().seconds()) + absl::Nanoseconds(info.retry_delay().nanos());
  return std::clamp(delay, absl::ZeroDuration(), kMaxDelay);
}

}  // namespace

void AddLimitDetails(const absl::Status& status, DetailList* details) {
  const std::optional<LimitRefusal> refusal = LimitRefusalOf(status);
  if (!refusal) return;
  google::rpc::QuotaFailure failure;
  google::rpc::QuotaFailure::Violation* violation = failure.add_violations();
  violation->set_subject(refusal->subject);
  violation->set_description(refusal->limit);
  details->Add()->PackFrom(failure);
  if (refusal->retry_after) {
    google::rpc::RetryInfo info;
    const int64_t milliseconds = absl::ToInt64Milliseconds(*refusal->retry_after);
    info.mutable_retry_delay()->set_seconds(milliseconds / 1000);
    info.mutable_retry_delay()->set_nanos(static_cast<int32_t>(milliseconds % 1000) * 1'000'000);
    details->Add()->PackFrom(info);
  }
}

std::string LimitDetailsOf(const absl::Status& status) {
  google::rpc::Status message;
  AddLimitDetails(status, message.mutable_details());
  if (message.details().empty()) return "";
  message.set_code(static_cast<int>(status.code()));
  message.set_message(ToValidUtf8(std::string(status.message())));
  return message.SerializeAsString();
}

absl::Status WithLimitDetails(const absl::Status& status, const std::string& details) {
  google::rpc::Status message;
  if (details.empty() || !message.ParseFromString(details)) return status;
  return WithLimitDetails(status, message.details());
}

absl::Status WithLimitDetails(const absl::Status& status, const DetailList& details) {
  if (!absl::IsResourceExhausted(status)) return status;
  LimitRefusal refusal;
  bool is_refusal = false;
  for (const google::protobuf::Any& detail : details) {
    google::rpc::QuotaFailure failure;
    google::rpc::RetryInfo info;
    if (detail.UnpackTo(&failure) && failure.violations_size() > 0) {
      is_refusal = true;
      refusal.subject = EscapeControls(failure.violations(0).subject());
      refusal.limit = failure.violations(0).description();
    } else if (detail.UnpackTo(&info)) {
      is_refusal = true;
      refusal.retry_after = DelayOf(info);
    }
  }
  return is_refusal ? RefuseForLimit(refusal, status.message()) : status;
}

}  // namespace pleat
