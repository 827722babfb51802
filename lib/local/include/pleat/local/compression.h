// Compression with its report, as jobs and `pleat compress` run it.
#pragma once

#include <string>

#include "absl/status/statusor.h"
#include "pleat/service/character_service.h"

namespace pleat {

struct MeasuredCompression {
  std::string bytes;         // of the .plt
  CompressionRecord record;  // without sequence_id
};

// CompressSequence, then decodes all frames once more on this thread to measure how long that
// takes. Stages of `progress`: "analyse", "encode", "check", "decode".
absl::StatusOr<MeasuredCompression> CompressMeasured(const MeshSequence& sequence,
                                                     const CompressOptions& options,
                                                     const Progress& progress);

}  // namespace pleat
