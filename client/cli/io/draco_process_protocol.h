// What pleat-draco writes: this header, positions (3 x N float32), triangles (3 x F int32), and
// vertex numbers (N int32) when has_numbers is 1. Both ends belong to one build on one machine, so
// there is neither a version nor an order of bytes.
#pragma once

#include <cstdint>

namespace pleat {

inline constexpr uint32_t kDracoReplyMagic = 0x504c4452;

struct DracoReplyHeader {
  uint32_t magic = 0;
  uint32_t num_positions = 0, num_triangles = 0, has_numbers = 0;
};

}  // namespace pleat
