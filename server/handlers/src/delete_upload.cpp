#include "pleat/base/content_id.h"
#include "pleat/base/status.h"
#include "pleat/handlers/unary_handlers.h"

namespace pleat {

absl::Status DeleteUpload(HandlerContext& context, const v1::DeleteUploadRequest& request,
                          v1::DeleteUploadResponse*) {
  PLEAT_RETURN_IF_ERROR(CheckContentId(request.id(), "id"));
  return context.sequences->DeleteUpload(request.id());
}

}  // namespace pleat
