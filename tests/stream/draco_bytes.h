// What an encoder of lib/stream/src/draco_encode.h writes, as a new string, and the box of the
// torus that tests encode.
#pragma once

#include <string>

#include "absl/status/statusor.h"
#include "pleat/base/status.h"
#include "pleat/stream/stream_header.h"

namespace pleat {

// Around MakeTorus, with 2^bits steps.
inline QuantizationBox TorusBox(int bits = 12) {
  return {.origin_m = {-1.6f, -.7f, -1.6f}, .range_m = 3.2f, .bits = bits};
}

// encode: such a function; args: its arguments without the bytes.
template <typename Encode, typename... Args>
absl::StatusOr<std::string> DracoBytes(Encode encode, const Args&... args) {
  std::string bytes;
  PLEAT_RETURN_IF_ERROR(encode(args..., &bytes));
  return bytes;
}

}  // namespace pleat
