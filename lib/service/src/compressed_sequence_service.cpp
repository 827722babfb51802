#include "pleat/service/compressed_sequence_service.h"

#include "pleat/base/status.h"

namespace pleat {

absl::Status DecodeInto(DecodeSession& session, FrameRange range, const DecodedFramesSink& sink) {
  PLEAT_ASSIGN_OR_RETURN(const MeshSequence shape, session.Shape());
  PLEAT_RETURN_IF_ERROR(sink.on_shape(shape));
  for (int t = range.begin;; ++t) {
    PLEAT_ASSIGN_OR_RETURN(const Eigen::Matrix3Xf* positions, session.Next());
    if (positions == nullptr) return absl::OkStatus();
    PLEAT_RETURN_IF_ERROR(sink.on_frame(t, *positions));
  }
}

absl::Status DecodeFrames(CompressedSequenceService& compressed, const std::string& id,
                          FrameRange range, const DecodedFramesSink& sink) {
  PLEAT_ASSIGN_OR_RETURN(const std::unique_ptr<DecodeSession> session,
                         compressed.OpenDecode(id, range));
  return DecodeInto(*session, range, sink);
}

}  // namespace pleat
