// One number for each vertex, as paint programs and scripts write it: the strength of the detail.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "absl/status/statusor.h"
#include "pleat/mesh/mesh_limits.h"

namespace pleat {

// Reads a NumPy array (.npy) of shape (V) or (V, 1), floats or integers, or a JSON list of numbers
// from hostile bytes. kInvalidArgument says what the file holds instead or which vertex has no
// finite number, kResourceExhausted the limit on vertices.
absl::StatusOr<std::vector<float>> DecodeVertexChannel(std::string_view bytes,
                                                       const MeshLimits& limits = {});
absl::StatusOr<std::vector<float>> ReadVertexChannel(const std::string& path,
                                                     const MeshLimits& limits = {});

}  // namespace pleat
