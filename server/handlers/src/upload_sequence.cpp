#include "pleat/base/status.h"
#include "pleat/handlers/stream_handlers.h"
#include "pleat/reactors/upload_stream.h"
#include "pleat/wire/service_messages.h"

namespace pleat {

grpc::ServerReadReactor<v1::UploadSequenceRequest>* UploadSequence(
    HandlerContext* context, v1::UploadSequenceResponse* response) {
  using Begun = absl::StatusOr<std::unique_ptr<ContentUpload<SequenceInfo>>>;
  using Response = v1::UploadSequenceResponse;
  SequenceService* sequences = context->sequences;
  return StartReactor<UploadStream<SequenceInfo, Response>>(
      context, response,
      UploadTarget<SequenceInfo, Response>{
          .rpc = "UploadSequence",
          .begin = [sequences](const v1::UploadSequenceRequest::Header& header) -> Begun {
            PLEAT_ASSIGN_OR_RETURN(const absl::Duration ttl,
                                   TtlFromSeconds(header.ttl_seconds(), "header.ttl_seconds"));
            return sequences->BeginUpload(header.id(), header.size_bytes(), header.offset_bytes(),
                                          ttl);
          },
          .reply = [](const SequenceInfo& info,
                      Response* reply) { *reply->mutable_sequence() = ToProto(info); }});
}

}  // namespace pleat
