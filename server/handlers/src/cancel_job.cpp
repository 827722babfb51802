
#include "pleat/base/status.h"
#include "pleat/handlers/unary_handlers.h"

namespace pleat {

absl::Status CancelJob(HandlerContext& context, const v1::CancelJobRequest& request,
                       v1::CancelJobResponse*) {
  return context.service->CancelJob(request.id());
}

}  // namespace pleat
