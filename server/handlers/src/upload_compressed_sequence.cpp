#include "pleat/base/status.h"
#include "pleat/handlers/stream_handlers.h"
#include "pleat/reactors/upload_stream.h"
#include "pleat/wire/service_messages.h"

namespace pleat {

grpc::ServerReadReactor<v1::UploadSequenceRequest>* UploadCompressedSequence(
    HandlerContext* context, v1::UploadCompressedSequenceResponse* response) {
  using Response = v1::UploadCompressedSequenceResponse;
  LocalCharacterService* service = context->service;
  return new UploadStream<Response>(
      context, response,
      {.rpc = "UploadCompressedSequence",
       .find = [service](const std::string& id, Response* reply) -> absl::Status {
         PLEAT_ASSIGN_OR_RETURN(const CompressedSequenceInfo info,
                                service->GetCompressedSequence(id));
         *reply->mutable_compressed_sequence() = ToProto(info);
         return absl::OkStatus();
       },
       .finish = [service](Upload* upload, Response* reply) -> absl::Status {
         PLEAT_ASSIGN_OR_RETURN(const CompressedSequenceInfo info,
                                service->FinishCompressedUpload(upload));
         *reply->mutable_compressed_sequence() = ToProto(info);
         return absl::OkStatus();
       }});
}

}  // namespace pleat
