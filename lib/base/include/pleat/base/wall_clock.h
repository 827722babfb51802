// The time of day. What needs it takes a clock as an argument, so that tests have clocks of their
// own.
#pragma once

#include <functional>

#include "absl/time/time.h"

namespace pleat {

using WallClock = std::function<absl::Time()>;

absl::Time SystemTime();  // that of this machine; it may jump

}  // namespace pleat
