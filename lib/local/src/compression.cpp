#include "pleat/local/compression.h"

#include "pleat/base/status.h"
#include "pleat/jobs/job_state_machine.h"
#include "pleat/sequence_codec/sequence_decoder.h"

namespace pleat {

absl::StatusOr<MeasuredCompression> CompressMeasured(const MeshSequence& sequence,
                                                     const CompressOptions& options,
                                                     const Progress& progress) {
  MeasuredCompression result;
  result.record.options = options;
  const double start_seconds = SteadySeconds();
  PLEAT_ASSIGN_OR_RETURN(result.bytes, CompressSequence(sequence, options, &result.record.summary,
                                                        progress.Stage("compress", 0, .95)));
  const double encoded_seconds = SteadySeconds();
  PLEAT_ASSIGN_OR_RETURN(SequenceDecoder decoder, SequenceDecoder::Open(result.bytes));
  PLEAT_RETURN_IF_ERROR(decoder.Decode(
      0, decoder.num_frames(), [](int, const Eigen::Matrix3Xf&) { return absl::OkStatus(); },
      progress.Stage("decode", .95, 1)));
  result.record.encode_seconds = encoded_seconds - start_seconds;
  result.record.decode_seconds = SteadySeconds() - encoded_seconds;
  return result;
}

}  // namespace pleat
