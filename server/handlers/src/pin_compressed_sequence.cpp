#include "pleat/base/content_id.h"
#include "pleat/base/status.h"
#include "pleat/handlers/unary_handlers.h"

namespace pleat {

absl::Status PinCompressedSequence(HandlerContext& context,
                                   const v1::PinCompressedSequenceRequest& request,
                                   v1::PinCompressedSequenceResponse*) {
  PLEAT_RETURN_IF_ERROR(CheckContentId(request.id(), "id"));
  return context.compressed_sequences->SetPinned(request.id(), request.pinned());
}

}  // namespace pleat
