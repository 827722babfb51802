#include "session_messages.h"

#include <utility>

#include "pleat/base/status.h"
#include "pleat/wire/stream_messages.h"

namespace pleat {

absl::StatusOr<SessionRequest> FromProto(const v1::Character& character,
                                         const v1::StreamOptions& options) {
  PLEAT_ASSIGN_OR_RETURN(CharacterQuery query, FromProto(character));
  SessionRequest request;
  request.model_id = std::move(query.model_id);
  request.options.bone_scales = std::move(query.bone_scales);
  request.options.skinned_only = query.skinned_only;
  PLEAT_ASSIGN_OR_RETURN(request.options.encoder, FromProto(options));
  return request;
}

v1::Frame ToProto(uint64_t number, EncodedFrame frame) {
  v1::Frame message;
  message.set_number(number);
  *message.mutable_draco() = std::move(frame.draco);
  message.set_confidence(frame.confidence);
  message.set_difference(!frame.mark.keyframe);
  message.set_checksum(frame.mark.checksum);
  return message;
}

}  // namespace pleat
