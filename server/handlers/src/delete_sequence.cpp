#include "pleat/base/content_id.h"
#include "pleat/base/status.h"
#include "pleat/handlers/unary_handlers.h"

namespace pleat {

absl::Status DeleteSequence(HandlerContext& context, const v1::DeleteSequenceRequest& request,
                            v1::DeleteSequenceResponse*) {
  PLEAT_RETURN_IF_ERROR(CheckContentId(request.id(), "id"));
  return context.sequences->Delete(request.id());
}

}  // namespace pleat
