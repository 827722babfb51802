#include "pleat/base/status.h"
#include "pleat/handlers/unary_handlers.h"
#include "pleat/wire/service_messages.h"

namespace pleat {

absl::Status GetJob(HandlerContext& context, const v1::GetJobRequest& request,
                    v1::GetJobResponse* response) {
  PLEAT_ASSIGN_OR_RETURN(const JobInfo info, context.jobs->Get(request.id()));
  *response->mutable_job() = ToProto(info);
  return absl::OkStatus();
}

}  // namespace pleat
