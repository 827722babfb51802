// What no computation may take for a number.
#pragma once

#include <limits>

namespace pleat {

inline constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

}  // namespace pleat
