#include "pleat/base/status.h"
#include "pleat/handlers/unary_handlers.h"
#include "pleat/wire/skeleton_messages.h"

namespace pleat {

absl::Status DeleteCompressedSequence(HandlerContext& context,
                                      const v1::DeleteCompressedSequenceRequest& request,
                                      v1::DeleteCompressedSequenceResponse*) {
  PLEAT_RETURN_IF_ERROR(CheckContentId(request.id(), "id"));
  return context.service->DeleteCompressedSequence(request.id());
}

}  // namespace pleat
