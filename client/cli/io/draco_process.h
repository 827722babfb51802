// Decodes Draco files in a child process (pleat-draco) under limits of memory and time.
#pragma once

#include <cstdint>
#include <string>

#include "absl/status/statusor.h"
#include "pleat/base/progress.h"
#include "pleat/formats/mesh_file.h"
#include "pleat/stream/draco_file.h"

namespace pleat {

struct DracoProcessOptions {
  uint64_t memory_bytes = uint64_t{1} << 30;  // addresses of the child
  int cpu_seconds = 20;                       // of the child
  double wall_seconds = 60;                   // until it is killed
  MeshLimits limits{};
};

struct DracoProcessUsage {
  uint64_t peak_memory_bytes = 0;  // resident, of the child
};

// Decodes the file `path`. Errors name it: kNotFound; kDataLoss: malformed, or the decoder crashed;
// kResourceExhausted: over a limit of size, memory or time; kCancelled within .1 s. What the child
// says is checked as if it were hostile itself. `usage` may be null.
absl::StatusOr<DracoGeometry> DecodeDracoInChild(const std::string& path,
                                                 const Progress& progress = {},
                                                 const DracoProcessOptions& options = {},
                                                 DracoProcessUsage* usage = nullptr);

// The same as a mesh: triangles over the position values in the order of the file.
// kInvalidArgument: a point cloud.
absl::StatusOr<MeshFile> ReadDracoMesh(const std::string& path, const Progress& progress);

}  // namespace pleat
