// Compression and decompression as a service and the command line do them in their own process.
#pragma once

#include <memory>
#include <string>

#include "absl/status/statusor.h"
#include "pleat/sequence_codec/sequence_decoder.h"
#include "pleat/service/compressed_sequence_service.h"

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

// The frames of `range` from a file that has been opened. kInvalidArgument when the range is not
// inside the sequence.
absl::StatusOr<std::unique_ptr<DecodeSession>> MakeDecodeSession(SequenceDecoder decoder,
                                                                 FrameRange range);

}  // namespace pleat
