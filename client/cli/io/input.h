// Reads INPUT arguments, with progress and Ctrl-C.
#pragma once

#include <string>

#include "absl/status/statusor.h"
#include "cli/session.h"
#include "pleat/mesh/mesh_sequence.h"

namespace pleat {

// Reads what ReadSequence reads, and folders of Draco frames (draco_folder.h). fps: the text of
// --fps, empty when it was not given.
absl::StatusOr<MeshSequence> ReadInput(const Session& session, const std::string& input,
                                       const std::string& fps = "");

}  // namespace pleat
