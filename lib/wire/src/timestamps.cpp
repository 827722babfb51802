#include "timestamps.h"

#include <algorithm>

#include "absl/strings/str_cat.h"
#include "pleat/wire/service_messages.h"

namespace pleat {
namespace {

// 0001-01-01T00:00:00Z and the last second of 9999, as timestamp.proto says.
constexpr int64_t kMinSeconds = -62'135'596'800;
constexpr int64_t kMaxSeconds = 253'402'300'799;
constexpr int kNanosPerSecond = 1'000'000'000;

constexpr int64_t kMaxTtlSeconds = int64_t{100} * 365 * 24 * 3600;

}  // namespace

google::protobuf::Timestamp ToProto(absl::Time time) {
  const absl::Time bounded =
      std::clamp(time, absl::FromUnixSeconds(kMinSeconds), absl::FromUnixSeconds(kMaxSeconds));
  google::protobuf::Timestamp message;
  message.set_seconds(absl::ToUnixSeconds(bounded));
  message.set_nanos(static_cast<int32_t>(
      absl::ToInt64Nanoseconds(bounded - absl::FromUnixSeconds(message.seconds()))));
  return message;
}

absl::StatusOr<absl::Time> FromProto(const google::protobuf::Timestamp& message,
                                     const std::string& what) {
  if (message.seconds() < kMinSeconds || message.seconds() > kMaxSeconds || message.nanos() < 0 ||
      message.nanos() >= kNanosPerSecond) {
    return absl::InvalidArgumentError(
        absl::StrCat(what, " is ", message.seconds(), " s and ", message.nanos(),
                     " ns since 1970, which is no time of a calendar"));
  }
  return absl::FromUnixSeconds(message.seconds()) + absl::Nanoseconds(message.nanos());
}

int64_t TtlToSeconds(absl::Duration ttl) {
  if (ttl == kKeepForEver) return 0;
  const int64_t seconds = absl::ToInt64Seconds(absl::Ceil(ttl, absl::Seconds(1)));
  return std::clamp<int64_t>(seconds, 1, kMaxTtlSeconds);
}

absl::StatusOr<absl::Duration> TtlFromSeconds(int64_t seconds, const std::string& what) {
  if (seconds < 0 || seconds > kMaxTtlSeconds) {
    return absl::InvalidArgumentError(absl::StrCat(what, " is ", seconds, " s, allowed are 1 to ",
                                                   kMaxTtlSeconds, ", and 0 for ever"));
  }
  return seconds == 0 ? kKeepForEver : absl::Seconds(seconds);
}

}  // namespace pleat
