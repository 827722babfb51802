// Reads INPUT arguments, with progress and Ctrl-C.
#pragma once

#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "cli/session.h"
#include "pleat/mesh/input_note.h"
#include "pleat/mesh/mesh_sequence.h"

namespace pleat {

// Reads what ReadSequence reads, and folders of Draco frames (draco_folder.h). fps: the text of
// --fps, empty when it was not given. What the reader noticed and frames that jump are printed on
// session.err and appended to `notes` (may be null). kFailedPrecondition when --strict refuses one
// of them. report (may be null): what the input says about its times, and its notes once more.
absl::StatusOr<MeshSequence> ReadInput(const Session& session, const std::string& input,
                                       const std::string& fps = "",
                                       std::vector<InputNote>* notes = nullptr,
                                       InputReport* report = nullptr);

// Prints notes on session.err, as ReadInput does, and appends them to `collected` (may be null).
void SayNotes(const Session& session, const std::vector<InputNote>& notes,
              std::vector<InputNote>* collected);

// kInvalidArgument when the sequence, read from `input`, is a single frame.
absl::Status CheckIsClip(const MeshSequence& sequence, const std::string& input);

}  // namespace pleat
