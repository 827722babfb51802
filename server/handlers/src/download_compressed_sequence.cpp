#include "pleat/handlers/stream_handlers.h"
#include "pleat/reactors/download_stream.h"

namespace pleat {

grpc::ServerWriteReactor<v1::DownloadCompressedSequenceResponse>* DownloadCompressedSequence(
    HandlerContext* context, const v1::DownloadCompressedSequenceRequest& request) {
  CompressedSequenceService* compressed = context->compressed_sequences;
  return StartDownload<v1::DownloadCompressedSequenceResponse>(
      context, request.id(), request.offset_bytes(),
      {.rpc = "DownloadCompressedSequence",
       .open = [compressed](const std::string& id, uint64_t offset_bytes) {
         return compressed->OpenDownload(id, offset_bytes);
       }});
}

}  // namespace pleat
