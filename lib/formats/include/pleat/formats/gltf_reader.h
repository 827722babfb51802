// glTF 2.0 as one mesh: a binary file (.glb), or text (.gltf) with its buffers beside it.
#pragma once

#include <string>
#include <string_view>

#include "absl/status/statusor.h"
#include "pleat/formats/mesh_file.h"

namespace pleat {

// Reads the triangles that the default scene of a hostile GLB shows, in the pose and place of its
// nodes: the vertices of all primitives one after the other, those of one POSITION accessor once.
// Skinned meshes are posed by their joints. Texture coordinates are turned to those of OBJ, whose v
// points up. What is left out is in the notes (docs/formats/mesh.md). kInvalidArgument says why,
// kResourceExhausted names the limit that is exceeded. `file` is the name used in messages.
absl::StatusOr<MeshFile> DecodeGlb(std::string_view bytes, const std::string& file,
                                   const MeshLimits& limits = {});
// Reads either form; what the bytes are counts more than the ending.
absl::StatusOr<MeshFile> ReadGltf(const std::string& path, const MeshLimits& limits = {});

}  // namespace pleat
