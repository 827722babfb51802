// When something that a service keeps came.
#pragma once

#include <optional>

#include "absl/time/time.h"

namespace pleat {

struct EntryLife {
  std::optional<absl::Time> created;  // when it was first stored; none: not known
};

}  // namespace pleat
