// Points in time as text, in UTC wherever the command runs.
#pragma once

#include <optional>
#include <string>

#include "absl/time/time.h"
#include "pleat/service/entry_life.h"

namespace pleat {

// Returns "2026-11-30 21:05:09" for tables, or nothing for no time.
std::string TimeText(const std::optional<absl::Time>& time);
// Returns "pinned", when the life ends, or nothing when it does not.
std::string KeptUntilText(const EntryLife& life);
// Returns "1h2m3s" and the like; nothing unless both times are there.
std::string DurationText(const std::optional<absl::Time>& begin,
                         const std::optional<absl::Time>& end);
// Returns "2026-11-30T21:05:09.123Z" (RFC 3339) for JSON.
std::string TimeForJson(absl::Time time);

}  // namespace pleat
