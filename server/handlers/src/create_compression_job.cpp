#include "pleat/base/content_id.h"
#include "pleat/base/status.h"
#include "pleat/handlers/unary_handlers.h"
#include "pleat/wire/service_messages.h"
#include "pleat/wire/skeleton_messages.h"

namespace pleat {

absl::Status CreateCompressionJob(HandlerContext& context, const std::string& client,
                                  const v1::CreateCompressionJobRequest& request,
                                  v1::CreateCompressionJobResponse* response) {
  PLEAT_RETURN_IF_ERROR(CheckContentId(request.sequence_id(), "sequence_id"));
  PLEAT_RETURN_IF_ERROR(CheckRequestId(request.request_id()));
  PLEAT_ASSIGN_OR_RETURN(const CompressOptions options, FromProto(request.options()));
  PLEAT_ASSIGN_OR_RETURN(const absl::Duration ttl,
                         TtlFromSeconds(request.result_ttl_seconds(), "result_ttl_seconds"));
  PLEAT_ASSIGN_OR_RETURN(const JobInfo info,
                         context.jobs->CreateCompression({.sequence_id = request.sequence_id(),
                                                          .options = options,
                                                          .request_id = request.request_id(),
                                                          .client = client,
                                                          .result_ttl = ttl}));
  *response->mutable_job() = ToProto(info);
  return absl::OkStatus();
}

}  // namespace pleat
