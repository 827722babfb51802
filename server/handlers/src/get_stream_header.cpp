#include "pleat/base/content_id.h"
#include "pleat/base/status.h"
#include "pleat/handlers/unary_handlers.h"
#include "pleat/wire/skeleton_messages.h"
#include "pleat/wire/stream_messages.h"

namespace pleat {

absl::Status GetStreamHeader(HandlerContext& context, const v1::GetStreamHeaderRequest& request,
                             v1::GetStreamHeaderResponse* response) {
  PLEAT_RETURN_IF_ERROR(CheckContentId(request.model_id(), "model_id"));
  PLEAT_ASSIGN_OR_RETURN(const FrameEncoderOptions encoder, FromProto(request.options()));
  PLEAT_ASSIGN_OR_RETURN(const std::unique_ptr<PoseSession> session,
                         context.poses->OpenSession(request.model_id(), {.encoder = encoder}));
  *response->mutable_header() = ToProto(session->header());
  return absl::OkStatus();
}

}  // namespace pleat
