#include "pleat/handlers/stream_handlers.h"
#include "pleat/reactors/upload_stream.h"
#include "pleat/wire/service_messages.h"

namespace pleat {

grpc::ServerReadReactor<v1::UploadSequenceRequest>* UploadCompressedSequence(
    HandlerContext* context, v1::UploadCompressedSequenceResponse* response) {
  using Response = v1::UploadCompressedSequenceResponse;
  CompressedSequenceService* compressed = context->compressed_sequences;
  return StartReactor<UploadStream<CompressedSequenceInfo, Response>>(
      context, response,
      UploadTarget<CompressedSequenceInfo, Response>{
          .rpc = "UploadCompressedSequence",
          .find = [compressed](const std::string& id) { return compressed->Get(id); },
          .begin =
              [compressed](const std::string& id, uint64_t size_bytes, uint64_t offset_bytes) {
                return compressed->BeginUpload(id, size_bytes, offset_bytes);
              },
          .reply = [](const CompressedSequenceInfo& info,
                      Response* reply) { *reply->mutable_compressed_sequence() = ToProto(info); }});
}

}  // namespace pleat
