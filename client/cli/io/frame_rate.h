// Frame rates as people write them.
#pragma once

#include <string>

#include "absl/status/statusor.h"
#include "pleat/mesh/mesh_sequence.h"

namespace pleat {

// "30", "29.97" (up to three decimals, kept exact) or "30000/1001"; a usage error otherwise.
absl::StatusOr<FrameRate> ParseFrameRate(const std::string& text);

// "30", "23.976" or "30000/1001": the exact inverse.
std::string FormatFrameRate(FrameRate rate);

// The fraction that people mean by `fps`: 29.97003 is 30000/1001. fps: above 0, at most 10000.
FrameRate FrameRateFromFps(double fps);

}  // namespace pleat
