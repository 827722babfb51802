// glTF as text (.gltf), whose buffers lie in files beside it or in the text itself.
#pragma once

#include <string>
#include <string_view>

#include "absl/status/statusor.h"
#include "pleat/mesh/mesh_limits.h"

namespace pleat {

// True for text that holds a glTF document: a JSON object with a member "asset".
bool IsGltfText(std::string_view bytes);

// The document as a binary file (GLB) of one buffer, which is what is read further. Buffers are
// taken from data URIs and from files in the folder of `path` or below it; nothing else is opened.
// kInvalidArgument names what is missing or elsewhere.
absl::StatusOr<std::string> PackGltf(std::string_view text, const std::string& path,
                                     const MeshLimits& limits);

// The bytes of the file `path` as a GLB, whichever form it has. What is neither is returned as it
// is, for the reader of GLB to refuse.
absl::StatusOr<std::string> ReadGltfBytes(const std::string& path, const MeshLimits& limits);

// What comes before the binary chunk of a GLB of two chunks. That chunk must be padded with zeros
// to a multiple of 4 bytes, and both together have less than 4 GiB.
std::string GlbStart(std::string document, size_t binary_bytes);

}  // namespace pleat
