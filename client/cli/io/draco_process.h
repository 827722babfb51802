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
  uint64_t memory_bytes = uint64_t{1} << 30;  // the address space of the child
  int cpu_seconds = 20;                       // the processor time of the child
  double wall_seconds = 60;                   // the elapsed time after which it is killed
  MeshLimits limits{};
  std::string program{};  // the child; empty = pleat-draco beside this program
};

struct DracoProcessUsage {
  uint64_t peak_memory_bytes = 0;  // the largest resident size of the child
};

// Decodes the file `path`. Errors name it: kNotFound; kDataLoss when it is malformed or the decoder
// crashed; kResourceExhausted when it exceeds a limit of size, memory or time; kCancelled within .1
// s of the cancellation. What the child says is checked as if it were hostile itself. `usage` may
// be null.
absl::StatusOr<DracoGeometry> DecodeDracoInChild(const std::string& path,
                                                 const Progress& progress = {},
                                                 const DracoProcessOptions& options = {},
                                                 DracoProcessUsage* usage = nullptr);

// Does the same and returns a mesh: triangles over the position values in the order of the file.
// kInvalidArgument when the file holds a point cloud.
absl::StatusOr<MeshFile> ReadDracoMesh(const std::string& path, const Progress& progress);

}  // namespace pleat
