#include "pleat/base/content_id.h"
#include "pleat/base/status.h"
#include "pleat/handlers/unary_handlers.h"

namespace pleat {

absl::Status DeleteModel(HandlerContext& context, const v1::DeleteModelRequest& request,
                         v1::DeleteModelResponse*) {
  PLEAT_RETURN_IF_ERROR(CheckContentId(request.id(), "id"));
  return context.models->Delete(request.id());
}

}  // namespace pleat
