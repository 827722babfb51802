#include "pleat/base/content_id.h"
#include "pleat/base/status.h"
#include "pleat/handlers/unary_handlers.h"
#include "pleat/wire/service_messages.h"

namespace pleat {

absl::Status GetModel(HandlerContext& context, const v1::GetModelRequest& request,
                      v1::GetModelResponse* response) {
  PLEAT_RETURN_IF_ERROR(CheckContentId(request.id(), "id"));
  PLEAT_ASSIGN_OR_RETURN(const ModelInfo info, context.models->Get(request.id()));
  *response->mutable_model() = ToProto(info);
  return absl::OkStatus();
}

}  // namespace pleat
