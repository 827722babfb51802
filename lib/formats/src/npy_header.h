// The header of NumPy's array files: a Python dictionary as text.
#pragma once

#include <string_view>

#include "absl/status/statusor.h"
#include "npy_array.h"

namespace pleat {

// Reads what stands before the items; data stays empty. num_bytes: how long the header is.
absl::StatusOr<NpyArray> ParseNpyHeader(std::string_view bytes, size_t* num_bytes);

}  // namespace pleat
