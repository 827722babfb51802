#include "pleat/base/content_id.h"
#include "pleat/base/status.h"
#include "pleat/handlers/unary_handlers.h"
#include "pleat/wire/service_messages.h"
#include "pleat/wire/skeleton_messages.h"
#include "pleat/wire/training_messages.h"

namespace pleat {

absl::Status CreateTrainingJob(HandlerContext& context, const std::string& client,
                               const v1::CreateTrainingJobRequest& request,
                               v1::CreateTrainingJobResponse* response) {
  for (const std::string& id : request.sequence_ids()) {
    PLEAT_RETURN_IF_ERROR(CheckContentId(id, "sequence_ids"));
  }
  PLEAT_RETURN_IF_ERROR(CheckName(request.model_name(), "model_name"));
  PLEAT_RETURN_IF_ERROR(CheckRequestId(request.request_id()));
  PLEAT_ASSIGN_OR_RETURN(const TrainOptions options, FromProto(request.options()));
  PLEAT_ASSIGN_OR_RETURN(const absl::Duration ttl,
                         TtlFromSeconds(request.model_ttl_seconds(), "model_ttl_seconds"));
  PLEAT_ASSIGN_OR_RETURN(
      const JobInfo info,
      context.jobs->CreateTraining(
          {.sequence_ids = {request.sequence_ids().begin(), request.sequence_ids().end()},
           .options = options,
           .model_name = request.model_name(),
           .rig = request.rig(),
           .request_id = request.request_id(),
           .client = client,
           .model_ttl = ttl}));
  *response->mutable_job() = ToProto(info);
  return absl::OkStatus();
}

}  // namespace pleat
