// Reads Draco files from anywhere (.drc) into plain arrays. The bytes are treated as hostile.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string_view>
#include <vector>

#include "absl/status/statusor.h"
#include "pleat/mesh/mesh_limits.h"

namespace pleat {

struct DracoGeometry {
  // 3 x N, meters. For a mesh these are the position values in the order of the file; corners that
  // differ only in a texture coordinate share one. For a point cloud they are its points.
  Eigen::Matrix3Xf positions;
  // 3 x F. The entries are columns of `positions` and are known to exist. A point cloud has none.
  Eigen::Matrix3Xi triangles;
  // N entries, or empty: the first int32 generic attribute of a mesh, if it has one. Pleat's own
  // files keep the original vertex numbers there.
  std::vector<int32_t> vertex_numbers;
};

// Reads files written by Draco 1.1 or newer. The counts in the header and the declared attributes
// are compared with the limits before Draco allocates memory for them. This does not bound what
// Draco takes in between: a file of 61 bytes reached 20 GB and 56 s. Bytes from outside therefore
// belong in a process with a memory limit (client/draco_child). Returns kDataLoss for a malformed
// file and kResourceExhausted for one that exceeds a limit or the available memory.
absl::StatusOr<DracoGeometry> DecodeDracoFile(std::string_view bytes,
                                              const MeshLimits& limits = {});

}  // namespace pleat
