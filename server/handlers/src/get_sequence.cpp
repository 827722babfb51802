#include "pleat/base/content_id.h"
#include "pleat/base/status.h"
#include "pleat/handlers/unary_handlers.h"
#include "pleat/wire/service_messages.h"

namespace pleat {

absl::Status GetSequence(HandlerContext& context, const v1::GetSequenceRequest& request,
                         v1::GetSequenceResponse* response) {
  PLEAT_RETURN_IF_ERROR(CheckContentId(request.id(), "id"));
  PLEAT_ASSIGN_OR_RETURN(const SequenceInfo info, context.sequences->Get(request.id()));
  *response->mutable_sequence() = ToProto(info);
  return absl::OkStatus();
}

}  // namespace pleat
