#include "pleat/base/content_id.h"
#include "pleat/base/status.h"
#include "pleat/handlers/unary_handlers.h"

namespace pleat {

absl::Status PinSequence(HandlerContext& context, const v1::PinSequenceRequest& request,
                         v1::PinSequenceResponse*) {
  PLEAT_RETURN_IF_ERROR(CheckContentId(request.id(), "id"));
  return context.sequences->SetPinned(request.id(), request.pinned());
}

}  // namespace pleat
