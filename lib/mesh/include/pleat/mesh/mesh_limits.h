// How large the meshes, animations and models may be that a reader accepts from outside.
#pragma once

#include <cstdint>

#include "absl/status/status.h"

namespace pleat {

// Every reader and decoder checks the members that apply to its format before it allocates, and
// refuses what lies above with kResourceExhausted. Counts are int64_t, sizes in bytes uint64_t.
struct MeshLimits {
  uint64_t max_file_bytes = uint64_t{8} << 30;        // of any one file
  uint64_t max_document_bytes = uint64_t{256} << 20;  // of a rig or a motion, which is parsed whole
  int64_t max_vertices = 4'000'000;
  int64_t max_faces = 8'000'000;  // polygons, or triangles where the format has no others
  int64_t max_frames = 100'000;
  uint64_t max_sequence_bytes = uint64_t{8} << 30;  // T x V x 12: positions of all frames
  // The fields of one segment of a compressed sequence, which is what a decoder holds at a time.
  uint64_t max_field_bytes = uint64_t{2} << 30;
  // What a small model file could unfold to: the upsampled detail basis and the whiteners.
  uint64_t max_unfolded_bytes = uint64_t{4} << 30;
};

// What a file declares.
struct MeshCounts {
  int64_t num_vertices = 0, num_faces = 0, num_frames = 1;

  // Bytes of the positions of all frames (float32). Exact for counts that are within any limits.
  uint64_t position_bytes() const {
    return uint64_t{12} * static_cast<uint64_t>(num_vertices) * static_cast<uint64_t>(num_frames);
  }
};

// kResourceExhausted names the first count that is above its limit.
absl::Status CheckCounts(const MeshCounts& counts, const MeshLimits& limits);
// The same where a reader takes the positions of all frames into memory at once.
absl::Status CheckSequenceCounts(const MeshCounts& counts, const MeshLimits& limits);

}  // namespace pleat
