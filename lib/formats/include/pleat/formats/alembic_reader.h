// Alembic archives (.abc, Ogawa): meshes with their transforms applied.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "absl/status/statusor.h"
#include "pleat/base/progress.h"
#include "pleat/mesh/input_note.h"
#include "pleat/mesh/mesh_limits.h"
#include "pleat/mesh/mesh_sequence.h"

namespace pleat {

struct AlembicOptions {
  std::string name{};  // of the sequence
  // The path of a mesh, or of an object whose meshes are all read. Empty: all meshes that move, or
  // all when none does.
  std::string object{};
  std::optional<FrameRate> frame_rate{};  // unset: that of the samples where they have one
  MeshLimits limits{};
};

// Reads the meshes as one sequence, a frame for each sample (docs/formats/alembic.md). The error
// names `file`, the object and the fault; `report` (may be null) receives what is left out.
absl::StatusOr<MeshSequence> DecodeAlembic(std::string_view bytes, const std::string& file,
                                           const AlembicOptions& options = {},
                                           const Progress& progress = {},
                                           InputReport* report = nullptr);

}  // namespace pleat
