#include "pleat/base/status.h"
#include "pleat/handlers/stream_handlers.h"
#include "pleat/reactors/upload_stream.h"
#include "pleat/wire/service_messages.h"

namespace pleat {

grpc::ServerReadReactor<v1::UploadSequenceRequest>* UploadCompressedSequence(
    HandlerContext* context, v1::UploadCompressedSequenceResponse* response) {
  using Begun = absl::StatusOr<std::unique_ptr<ContentUpload<CompressedSequenceInfo>>>;
  using Response = v1::UploadCompressedSequenceResponse;
  CompressedSequenceService* compressed = context->compressed_sequences;
  return StartReactor<UploadStream<CompressedSequenceInfo, Response>>(
      context, response,
      UploadTarget<CompressedSequenceInfo, Response>{
          .rpc = "UploadCompressedSequence",
          .begin = [compressed](const v1::UploadSequenceRequest::Header& header) -> Begun {
            PLEAT_ASSIGN_OR_RETURN(const absl::Duration ttl,
                                   TtlFromSeconds(header.ttl_seconds(), "header.ttl_seconds"));
            return compressed->BeginUpload(header.id(), header.size_bytes(), header.offset_bytes(),
                                           ttl);
          },
          .reply = [](const CompressedSequenceInfo& info,
                      Response* reply) { *reply->mutable_compressed_sequence() = ToProto(info); }});
}

}  // namespace pleat
