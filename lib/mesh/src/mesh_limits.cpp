#include "pleat/mesh/mesh_limits.h"

#include "absl/strings/str_cat.h"
#include "pleat/base/status.h"

namespace pleat {
namespace {

absl::Status CheckCount(int64_t count, int64_t limit, absl::string_view what) {
  if (count <= limit) return absl::OkStatus();
  return absl::ResourceExhaustedError(
      absl::StrCat(count, " ", what, " are over the limit of ", limit, " ", what));
}

}  // namespace

absl::Status CheckCounts(const MeshCounts& counts, const MeshLimits& limits) {
  PLEAT_RETURN_IF_ERROR(CheckCount(counts.num_vertices, limits.max_vertices, "vertices"));
  PLEAT_RETURN_IF_ERROR(CheckCount(counts.num_faces, limits.max_faces, "faces"));
  return CheckCount(counts.num_frames, limits.max_frames, "frames");
}

absl::Status CheckSequenceCounts(const MeshCounts& counts, const MeshLimits& limits) {
  PLEAT_RETURN_IF_ERROR(CheckCounts(counts, limits));
  if (counts.position_bytes() <= limits.max_sequence_bytes) return absl::OkStatus();
  return absl::ResourceExhaustedError(absl::StrCat(
      counts.num_frames, " frames of ", counts.num_vertices, " vertices (", counts.position_bytes(),
      " bytes of positions) are over the limit of ", limits.max_sequence_bytes, " bytes"));
}

}  // namespace pleat
