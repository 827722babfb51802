#include "pleat/service/pose_service.h"

#include "pleat/base/status.h"

namespace pleat {

absl::Status StreamClip(PoseService& poses, const ClipQuery& query,
                        const FrameEncoderOptions& encoding, const ClipStreamSink& sink) {
  const bool has_parameters = encoding.content == StreamContent::kParameters;
  if (has_parameters ? !sink.on_parameters : !sink.on_frame) {
    return absl::InvalidArgumentError(
        "the sink takes no frames: set on_parameters of streams of parameters, else on_frame");
  }
  PLEAT_ASSIGN_OR_RETURN(const std::unique_ptr<ClipSession> clip,
                         poses.OpenClip(query.model_id, query.track,
                                        {.bone_scales = query.bone_scales,
                                         .skinned_only = query.skinned_only,
                                         .encoder = encoding,
                                         .strengths = query.strengths}));
  if (sink.on_header) PLEAT_RETURN_IF_ERROR(sink.on_header(clip->header()));
  while (!clip->done()) {
    const int t = clip->next_frame();
    PLEAT_ASSIGN_OR_RETURN(const EncodedFrame frame, clip->Next());
    if (!has_parameters) {
      PLEAT_RETURN_IF_ERROR(sink.on_frame(t, frame.draco, frame.mark, frame.confidence));
    } else if (frame.parameters.has_value()) {
      PLEAT_RETURN_IF_ERROR(sink.on_parameters(t, *frame.parameters));
    } else {
      return absl::DataLossError("a stream of parameters has a frame without them");
    }
  }
  return absl::OkStatus();
}

}  // namespace pleat
