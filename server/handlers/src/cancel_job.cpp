#include "pleat/handlers/unary_handlers.h"

namespace pleat {

absl::Status CancelJob(HandlerContext& context, const v1::CancelJobRequest& request,
                       v1::CancelJobResponse*) {
  return context.jobs->Cancel(request.id());
}

}  // namespace pleat
