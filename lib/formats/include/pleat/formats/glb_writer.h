// Writes animations as binary glTF (.glb): one morph target for each frame (docs/formats/glb.md).
#pragma once

#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "pleat/mesh/mesh_sequence.h"

namespace pleat {

// The mesh is frame 0; every other frame is a morph target whose weight is 1 at the time of its
// frame. Polygons become triangles, and vertices with several texture coordinates are repeated
// behind the others. ReadSequence reads the same positions, bit by bit. kResourceExhausted when the
// file would be larger than GLB allows (4 GiB).
absl::StatusOr<std::string> EncodeGlb(const MeshSequence& sequence);
absl::Status WriteGlb(const std::string& path, const MeshSequence& sequence);

}  // namespace pleat
