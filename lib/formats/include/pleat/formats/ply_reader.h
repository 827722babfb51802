// Stanford PLY (ASCII, binary little-endian and big-endian), read without changing the order or the
// number of its vertices.
#pragma once

#include <string>
#include <string_view>

#include "absl/status/statusor.h"
#include "pleat/formats/mesh_file.h"

namespace pleat {

// The file must have an element "vertex" with scalar properties x, y, z and an element "face" with
// a list vertex_indices or vertex_index. Texture coordinates are taken from a list "texcoord" of
// the face (u, v per corner), or from the vertex properties s and t, u and v, or texture_u and
// texture_v. All other elements and properties are skipped. kInvalidArgument names the file and the
// line or byte and says why, kResourceExhausted names the limit that is exceeded.
absl::StatusOr<MeshFile> DecodePly(std::string_view bytes, const std::string& file,
                                   const MeshLimits& limits = {});
absl::StatusOr<MeshFile> ReadPly(const std::string& path, const MeshLimits& limits = {});

}  // namespace pleat
