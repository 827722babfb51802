// Draco files from anywhere (.drc) -> plain arrays. Bytes are hostile.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string_view>
#include <vector>

#include "absl/status/statusor.h"
#include "pleat/mesh/mesh_limits.h"

namespace pleat {

struct DracoGeometry {
  // 3 x N, meters: the position values of a mesh in the order of the file (corners that differ in a
  // texture coordinate only share one), or the points of a point cloud.
  Eigen::Matrix3Xf positions;
  Eigen::Matrix3Xi triangles;  // 3 x F, columns of `positions`, checked; none in a point cloud
  // N or empty: the int32 generic attribute, where there is one (Pleat writes vertex numbers).
  std::vector<int32_t> vertex_numbers;
};

// Reads what Draco 1.1 or newer wrote. Counts in the header and the declared attributes are
// compared with the limits before Draco allocates for them; but what Draco takes in between is not
// bounded by them (61 bytes reached 20 GB and 56 s), so bytes from outside belong into a process
// with a memory limit (client/draco_child). kDataLoss: malformed. kResourceExhausted: over a limit,
// or no memory.
absl::StatusOr<DracoGeometry> DecodeDracoFile(std::string_view bytes,
                                              const MeshLimits& limits = {});

}  // namespace pleat
