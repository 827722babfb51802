// Writes Alembic archives (.abc, Ogawa).
#pragma once

#include <string>

#include "absl/status/status.h"
#include "pleat/mesh/mesh_sequence.h"

namespace pleat {

// One poly mesh below a transform that does nothing, with its texture coordinates and materials
// (docs/formats/alembic.md). DecodeAlembic reads the same positions, bit by bit.
// first_frame: its number on the timeline of the archive.
std::string EncodeAlembic(const MeshSequence& sequence, double first_frame = 0);
absl::Status WriteAlembic(const std::string& path, const MeshSequence& sequence,
                          double first_frame = 0);

}  // namespace pleat
