#include "pleat/local/decode_session.h"

#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "pleat/base/status.h"

namespace pleat {

absl::StatusOr<std::unique_ptr<DecodeSession>> DecodeSession::Open(SequenceDecoder decoder,
                                                                   FrameRange range,
                                                                   Reservation memory) {
  if (range.end == 0) range.end = decoder.num_frames();
  if (range.begin < 0 || range.begin >= range.end || range.end > decoder.num_frames()) {
    return absl::InvalidArgumentError(absl::StrCat("the frames ", range.begin, " to ", range.end,
                                                   " are not in the sequence, which has ",
                                                   decoder.num_frames()));
  }
  return std::unique_ptr<DecodeSession>(
      new DecodeSession(std::move(decoder), range, std::move(memory)));
}

absl::StatusOr<const Eigen::Matrix3Xf*> DecodeSession::Next() {
  return decoder_.DecodeFrame(next_++);
}

absl::StatusOr<MeshSequence> DecodeSession::Shape() {
  PLEAT_ASSIGN_OR_RETURN(const Eigen::Matrix3Xf* first, decoder_.DecodeFrame(next_));
  MeshSequenceOptions options;
  options.name = decoder_.name();
  options.frame_rate = decoder_.frame_rate();
  options.appearance = decoder_.appearance();
  std::vector<Eigen::Matrix3Xf> frames{*first};
  return MeshSequence::Create(decoder_.topology(), std::move(frames), std::move(options));
}

absl::Status DecodeInto(DecodeSession* session, const DecodedFramesSink& sink) {
  PLEAT_ASSIGN_OR_RETURN(const MeshSequence shape, session->Shape());
  PLEAT_RETURN_IF_ERROR(sink.on_shape(shape));
  while (!session->done()) {
    const int t = session->next_frame();
    PLEAT_ASSIGN_OR_RETURN(const Eigen::Matrix3Xf* positions, session->Next());
    PLEAT_RETURN_IF_ERROR(sink.on_frame(t, *positions));
  }
  return absl::OkStatus();
}

}  // namespace pleat
