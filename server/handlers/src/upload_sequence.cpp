#include "pleat/handlers/stream_handlers.h"
#include "pleat/reactors/upload_stream.h"
#include "pleat/wire/service_messages.h"

namespace pleat {

grpc::ServerReadReactor<v1::UploadSequenceRequest>* UploadSequence(
    HandlerContext* context, v1::UploadSequenceResponse* response) {
  using Response = v1::UploadSequenceResponse;
  SequenceService* sequences = context->sequences;
  return StartReactor<UploadStream<SequenceInfo, Response>>(
      context, response,
      UploadTarget<SequenceInfo, Response>{
          .rpc = "UploadSequence",
          .find = [sequences](const std::string& id) { return sequences->Get(id); },
          .begin =
              [sequences](const std::string& id, uint64_t size_bytes, uint64_t offset_bytes) {
                return sequences->BeginUpload(id, size_bytes, offset_bytes);
              },
          .reply = [](const SequenceInfo& info,
                      Response* reply) { *reply->mutable_sequence() = ToProto(info); }});
}

}  // namespace pleat
