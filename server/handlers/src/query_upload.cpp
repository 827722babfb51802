#include "pleat/base/content_id.h"
#include "pleat/base/status.h"
#include "pleat/handlers/unary_handlers.h"

namespace pleat {

absl::Status QueryUpload(HandlerContext& context, const v1::QueryUploadRequest& request,
                         v1::QueryUploadResponse* response) {
  PLEAT_RETURN_IF_ERROR(CheckContentId(request.id(), "id"));
  PLEAT_ASSIGN_OR_RETURN(const UploadStatus status, context.sequences->QueryUpload(request.id()));
  response->set_received_bytes(status.received_bytes);
  response->set_complete(status.complete);
  return absl::OkStatus();
}

}  // namespace pleat
