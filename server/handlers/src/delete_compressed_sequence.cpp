#include "pleat/base/content_id.h"
#include "pleat/base/status.h"
#include "pleat/handlers/unary_handlers.h"

namespace pleat {

absl::Status DeleteCompressedSequence(HandlerContext& context,
                                      const v1::DeleteCompressedSequenceRequest& request,
                                      v1::DeleteCompressedSequenceResponse*) {
  PLEAT_RETURN_IF_ERROR(CheckContentId(request.id(), "id"));
  return context.compressed_sequences->Delete(request.id());
}

}  // namespace pleat
