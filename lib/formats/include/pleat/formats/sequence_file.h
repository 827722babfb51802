// Pleat's canonical binary sequence file (docs/formats/sequence_file.md).
#pragma once

#include <string>
#include <string_view>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "pleat/formats/mesh_file.h"
#include "pleat/mesh/mesh_sequence.h"

namespace pleat {

// The same sequence always gives the same bytes.
std::string EncodeSequence(const MeshSequence& sequence);

// Reads a sequence from hostile bytes. kInvalidArgument says that they are no sequence file or of
// another version, or which values make no valid sequence; kDataLoss that they are cut off or
// corrupt; kResourceExhausted names the limit that they exceed.
absl::StatusOr<MeshSequence> DecodeSequence(std::string_view bytes, const MeshLimits& limits = {});

// Do the same with files; the errors name them.
absl::StatusOr<MeshSequence> ReadSequenceFile(const std::string& path,
                                              const MeshLimits& limits = {});
absl::Status WriteSequenceFile(const std::string& path, const MeshSequence& sequence);

// Returns the content id of a sequence file: the SHA-256 of its bytes as 64 lower-case hexadecimal
// digits.
std::string SequenceId(std::string_view bytes);

}  // namespace pleat
