// Writes animations as USD text (.usda) with time samples (docs/formats/usda.md).
#pragma once

#include <string>

#include "absl/status/status.h"
#include "pleat/mesh/mesh_sequence.h"

namespace pleat {

// What the file says about its space and its timeline.
struct UsdaOptions {
  double meters_per_unit = 1;
  bool is_z_up = false;
  double first_frame = 0;
};

// One mesh below a transform. Numbers are the shortest that read back as the same float32.
std::string EncodeUsda(const MeshSequence& sequence, const UsdaOptions& options = {});
absl::Status WriteUsda(const std::string& path, const MeshSequence& sequence,
                       const UsdaOptions& options = {});

}  // namespace pleat
