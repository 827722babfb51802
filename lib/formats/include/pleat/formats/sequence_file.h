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

// kInvalidArgument: not a sequence file, another version, or values that are no valid sequence.
// kDataLoss: cut off or corrupt. kResourceExhausted: above a limit.
absl::StatusOr<MeshSequence> DecodeSequence(std::string_view bytes, const MeshLimits& limits = {});

absl::StatusOr<MeshSequence> ReadSequenceFile(const std::string& path,
                                              const MeshLimits& limits = {});
absl::Status WriteSequenceFile(const std::string& path, const MeshSequence& sequence);

// Content id of a sequence file: SHA-256 of its bytes, 64 lower-case hexadecimal digits.
std::string SequenceId(std::string_view bytes);

}  // namespace pleat
