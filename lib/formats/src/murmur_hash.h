// MurmurHash3, the 128-bit variant for 64-bit machines (Austin Appleby, in the public domain): the
// keys of the samples of Alembic archives.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

namespace pleat {

// With seed 0. Fast and well spread, but not safe against somebody who wants two inputs to collide.
std::array<uint64_t, 2> MurmurHash3(std::string_view bytes);

}  // namespace pleat
