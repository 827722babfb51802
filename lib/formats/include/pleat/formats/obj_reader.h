// Wavefront OBJ, read without changing the order or the number of its vertices.
#pragma once

#include <string>
#include <string_view>

#include "absl/status/statusor.h"
#include "pleat/formats/mesh_file.h"

namespace pleat {

// Reads the statements v, vt, f (a, a/b, a//c, a/b/c, negative indices, polygons of any size),
// usemtl and mtllib. All others are skipped, normals included. What a character does not need is
// never a reason to refuse a file: it is left out, and the notes of the result say so
// (docs/formats/mesh.md). kInvalidArgument says "file:line" and why, kResourceExhausted names the
// limit that is exceeded. `file` is the name used in
// messages.
absl::StatusOr<MeshFile> DecodeObj(std::string_view text, const std::string& file,
                                   const MeshLimits& limits = {});
absl::StatusOr<MeshFile> ReadObj(const std::string& path, const MeshLimits& limits = {});

}  // namespace pleat
