#include "pleat/base/status.h"
#include "pleat/handlers/unary_handlers.h"
#include "pleat/wire/service_messages.h"

namespace pleat {

absl::Status ListJobs(HandlerContext& context, const v1::ListJobsRequest& request,
                      v1::ListJobsResponse* response) {
  PLEAT_ASSIGN_OR_RETURN(const Page<JobInfo> page,
                         context.jobs->ListPage({request.page_size(), request.page_token()}));
  for (const JobInfo& info : page.items) *response->add_jobs() = ToProto(info);
  response->set_next_page_token(page.next_token);
  return absl::OkStatus();
}

}  // namespace pleat
