#include "pleat/base/content_id.h"
#include "pleat/base/status.h"
#include "pleat/handlers/unary_handlers.h"

namespace pleat {

absl::Status PinModel(HandlerContext& context, const v1::PinModelRequest& request,
                      v1::PinModelResponse*) {
  PLEAT_RETURN_IF_ERROR(CheckContentId(request.id(), "id"));
  return context.models->SetPinned(request.id(), request.pinned());
}

}  // namespace pleat
