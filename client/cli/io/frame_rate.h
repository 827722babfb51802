// Frame rates as people write them.
#pragma once

#include <string>

#include "absl/status/statusor.h"
#include "pleat/mesh/mesh_sequence.h"

namespace pleat {

// Reads "30", "29.97" (up to three decimals, which are kept exactly) or "30000/1001". Everything
// else is a usage error.
absl::StatusOr<FrameRate> ParseFrameRate(const std::string& text);

// Writes "30", "23.976" or "30000/1001". ParseFrameRate restores the same rate exactly.
std::string FormatFrameRate(FrameRate rate);

// Returns the fraction that people mean by `fps`: 29.97003 is 30000/1001. fps: above 0, at most
// 10000.
FrameRate FrameRateFromFps(double fps);

}  // namespace pleat
