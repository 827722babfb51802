// The animation of one glTF file, as a sequence.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "absl/status/statusor.h"
#include "pleat/mesh/mesh_sequence.h"
#include "sequence_inputs.h"

namespace pleat {

// Samples the first animation of a hostile GLB. None where nothing moves, and for bytes that are no
// GLB, which the reader of still meshes refuses. The errors name `path`.
absl::StatusOr<std::optional<MeshSequence>> DecodeGlbAnimation(std::string_view bytes,
                                                               const std::string& path,
                                                               const InputReading& reading);

}  // namespace pleat
