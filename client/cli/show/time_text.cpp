#include "cli/show/time_text.h"

namespace pleat {

std::string TimeText(const std::optional<absl::Time>& time) {
  return time ? absl::FormatTime("%Y-%m-%d %H:%M:%S", *time, absl::UTCTimeZone()) : "";
}

std::string KeptUntilText(const EntryLife& life) {
  return life.pinned ? "pinned" : TimeText(life.expires);
}

std::string DurationText(const std::optional<absl::Time>& begin,
                         const std::optional<absl::Time>& end) {
  if (!begin || !end) return "";
  const absl::Duration duration = *end - *begin;
  const bool is_short = duration < absl::Seconds(10);
  return absl::FormatDuration(
      absl::Trunc(duration, is_short ? absl::Milliseconds(1) : absl::Seconds(1)));
}

std::string TimeForJson(absl::Time time) {
  return absl::FormatTime("%Y-%m-%dT%H:%M:%E3SZ", time, absl::UTCTimeZone());
}

}  // namespace pleat
