#include "pleat/base/wall_clock.h"

#include "absl/time/clock.h"

namespace pleat {

absl::Time SystemTime() { return absl::Now(); }

}  // namespace pleat
