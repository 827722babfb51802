#include "pleat/base/status.h"
#include "pleat/handlers/stream_handlers.h"
#include "pleat/reactors/upload_stream.h"
#include "pleat/wire/service_messages.h"

namespace pleat {

grpc::ServerReadReactor<v1::UploadSequenceRequest>* UploadSequence(
    HandlerContext* context, v1::UploadSequenceResponse* response) {
  using Response = v1::UploadSequenceResponse;
  LocalCharacterService* service = context->service;
  return new UploadStream<Response>(
      context, response,
      {.rpc = "UploadSequence",
       .find = [service](const std::string& id, Response* reply) -> absl::Status {
         PLEAT_ASSIGN_OR_RETURN(const SequenceInfo info, service->GetSequence(id));
         *reply->mutable_sequence() = ToProto(info);
         return absl::OkStatus();
       },
       .finish = [service](Upload* upload, Response* reply) -> absl::Status {
         PLEAT_ASSIGN_OR_RETURN(const SequenceInfo info, service->FinishUpload(upload));
         *reply->mutable_sequence() = ToProto(info);
         return absl::OkStatus();
       }});
}

}  // namespace pleat
