// Mesh sequence -> a compressed file with a promised error.
#pragma once

#include <cstdint>
#include <string>

#include "absl/status/statusor.h"
#include "pleat/base/progress.h"
#include "pleat/mesh/mesh_sequence.h"

namespace pleat {

enum class CompressionGoal {
  kMaxError,  // no vertex of any frame is further off than max_error_mm
  kKg,        // the KG error (Karni and Gotsman 2004) is at most kg_percent
  kGrid,      // positions are exact on a grid of grid_bits per coordinate
};

struct CompressOptions {
  CompressionGoal goal = CompressionGoal::kMaxError;
  double max_error_mm = 1;  // 1e-3 .. 1e6
  double kg_percent = 1;    // 1e-4 .. 50
  // The grid's cube is the bounding box of all frames: step = longest edge / (2^bits - 1). 8 .. 20
  int grid_bits = 12;
  // False: faces (with their texture coordinates and materials) may come back in another order and
  // from another first corner, which saves about 1.5 bytes each. Vertices always keep their order.
  bool keep_face_order = true;
  int num_threads = 0;  // 0 = one per core; the result does not depend on it

  friend bool operator==(const CompressOptions&, const CompressOptions&) = default;
};

// kInvalidArgument names an option that is out of range.
absl::Status ValidateCompressOptions(const CompressOptions& options);

// Measured on the decoded file.
struct CompressSummary {
  uint64_t num_bytes = 0;           // of the file
  uint64_t num_topology_bytes = 0;  // of them connectivity, face order and appearance
  double bpvf = 0;                  // bits per vertex and frame, all of the file
  double bpvf_without_topology = 0;
  double kg_percent = 0;    // 100 |A - B|_F / |A - E(A)|_F, E(A) the centroid of every frame
  double max_error_mm = 0;  // largest distance of a vertex
};

// Errors: kInvalidArgument for an option out of range, a sequence without motion or extent for a KG
// goal, or a bound that float32 positions cannot keep; kCancelled. `summary` may be null.
absl::StatusOr<std::string> CompressSequence(const MeshSequence& sequence,
                                             const CompressOptions& options,
                                             CompressSummary* summary,
                                             const Progress& progress = {});

}  // namespace pleat
