// What pleat-draco writes: this header, positions (3 x N float32), triangles (3 x F int32), vertex
// numbers (N int32, where has_numbers is 1). Both ends are one build on one machine.
#pragma once

#include <cstdint>

namespace pleat {

inline constexpr uint32_t kDracoReplyMagic = 0x504c4452;

struct DracoReplyHeader {
  uint32_t magic = 0;
  uint32_t num_positions = 0, num_triangles = 0, has_numbers = 0;
};

}  // namespace pleat
