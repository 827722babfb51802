// What an encoder of lib/stream/src/draco_encode.h writes, as a new string.
#pragma once

#include <string>

#include "absl/status/statusor.h"
#include "pleat/base/status.h"

namespace pleat {

// encode: such a function; args: its arguments without the bytes.
template <typename Encode, typename... Args>
absl::StatusOr<std::string> DracoBytes(Encode encode, const Args&... args) {
  std::string bytes;
  PLEAT_RETURN_IF_ERROR(encode(args..., &bytes));
  return bytes;
}

}  // namespace pleat
