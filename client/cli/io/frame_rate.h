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

}  // namespace pleat
