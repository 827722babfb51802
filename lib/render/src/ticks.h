// Round values for axes and legends.
#pragma once

#include <string>
#include <vector>

namespace pleat {

// Returns about `wanted` multiples of 1, 2 or 5 times a power of ten in [low, high], high > low.
std::vector<double> RoundTicks(double low, double high, int wanted);

// Returns `value` with as many digits as ticks `step` apart need.
std::string TickLabel(double value, double step);

}  // namespace pleat
