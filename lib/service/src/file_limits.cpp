#include "pleat/service/file_limits.h"

#include <cstdint>

namespace pleat {

MeshLimits FileLimits(const ServiceLimits& limits) {
  const auto max_bytes = static_cast<uint64_t>(limits.max_upload_bytes);
  return {.max_file_bytes = max_bytes,
          .max_vertices = limits.max_vertices,
          .max_faces = 2 * limits.max_vertices,
          .max_frames = limits.max_frames,
          .max_sequence_bytes = 2 * max_bytes};
}

}  // namespace pleat
