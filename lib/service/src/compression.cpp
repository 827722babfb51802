#include "pleat/service/compression.h"

#include <chrono>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "pleat/base/status.h"

namespace pleat {
namespace {

using Clock = std::chrono::steady_clock;

double SecondsBetween(Clock::time_point start, Clock::time_point end) {
  return std::chrono::duration<double>(end - start).count();
}

class DecoderSession final : public DecodeSession {
 public:
  DecoderSession(SequenceDecoder decoder, FrameRange range)
      : decoder_(std::move(decoder)), end_(range.end), next_(range.begin) {}

  absl::StatusOr<MeshSequence> Shape() override {
    PLEAT_ASSIGN_OR_RETURN(const Eigen::Matrix3Xf* first, decoder_.DecodeFrame(next_));
    MeshSequenceOptions options;
    options.name = decoder_.name();
    options.frame_rate = decoder_.frame_rate();
    options.appearance = decoder_.appearance();
    std::vector<Eigen::Matrix3Xf> frames{*first};
    return MeshSequence::Create(decoder_.topology(), std::move(frames), std::move(options));
  }

  absl::StatusOr<const Eigen::Matrix3Xf*> Next() override {
    if (next_ >= end_) return nullptr;
    return decoder_.DecodeFrame(next_++);
  }

 private:
  SequenceDecoder decoder_;
  const int end_;
  int next_;
};

}  // namespace

absl::StatusOr<MeasuredCompression> CompressMeasured(const MeshSequence& sequence,
                                                     const CompressOptions& options,
                                                     const Progress& progress) {
  MeasuredCompression result;
  result.record.options = options;
  const Clock::time_point start = Clock::now();
  PLEAT_ASSIGN_OR_RETURN(result.bytes, CompressSequence(sequence, options, &result.record.summary,
                                                        progress.Stage("compress", 0, .95)));
  const Clock::time_point encoded = Clock::now();
  PLEAT_ASSIGN_OR_RETURN(SequenceDecoder decoder, SequenceDecoder::Open(result.bytes));
  PLEAT_RETURN_IF_ERROR(decoder.Decode(
      0, decoder.num_frames(), [](int, const Eigen::Matrix3Xf&) { return absl::OkStatus(); },
      progress.Stage("decode", .95, 1)));
  result.record.encode_seconds = SecondsBetween(start, encoded);
  result.record.decode_seconds = SecondsBetween(encoded, Clock::now());
  return result;
}

absl::StatusOr<std::unique_ptr<DecodeSession>> MakeDecodeSession(SequenceDecoder decoder,
                                                                 FrameRange range) {
  if (range.end == 0) range.end = decoder.num_frames();
  if (range.begin < 0 || range.begin >= range.end || range.end > decoder.num_frames()) {
    return absl::InvalidArgumentError(absl::StrCat("the frames ", range.begin, " to ", range.end,
                                                   " are not in the sequence, which has ",
                                                   decoder.num_frames()));
  }
  return std::make_unique<DecoderSession>(std::move(decoder), range);
}

}  // namespace pleat
