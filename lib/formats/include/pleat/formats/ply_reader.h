// Stanford PLY (ascii, binary little- and big-endian), vertex order and count untouched.
#pragma once

#include <string>
#include <string_view>

#include "absl/status/statusor.h"
#include "pleat/formats/mesh_file.h"

namespace pleat {

// Needs an element "vertex" with scalar properties x, y, z and an element "face" with a list
// vertex_indices or vertex_index. Texture coordinates are taken from a face list "texcoord" (u, v
// per corner) or from vertex properties s, t / u, v / texture_u, texture_v. All other elements and
// properties are skipped. kInvalidArgument says file, line or byte, and why.
absl::StatusOr<MeshFile> DecodePly(std::string_view bytes, const std::string& file,
                                   const MeshLimits& limits = {});
absl::StatusOr<MeshFile> ReadPly(const std::string& path, const MeshLimits& limits = {});

}  // namespace pleat
