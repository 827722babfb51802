#include "pleat/handlers/unary_handlers.h"

namespace pleat {

absl::Status DeleteJob(HandlerContext& context, const v1::DeleteJobRequest& request,
                       v1::DeleteJobResponse*) {
  return context.jobs->Delete(request.id());
}

}  // namespace pleat
