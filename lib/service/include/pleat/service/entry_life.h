// When something that a service keeps came, and how long it stays.
#pragma once

#include <optional>

#include "absl/time/time.h"

namespace pleat {

// A time to live that does not end.
inline constexpr absl::Duration kKeepForEver = absl::InfiniteDuration();

struct EntryLife {
  std::optional<absl::Time> created{};  // when it was first stored; none: not known
  // When its time to live is over: from then on retention may remove it. None: never. Of several
  // uploads of one content the longest life counts.
  std::optional<absl::Time> expires{};
  bool pinned = false;  // retention never removes it
};

}  // namespace pleat
