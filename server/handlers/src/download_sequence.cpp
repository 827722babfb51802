#include "pleat/handlers/stream_handlers.h"
#include "pleat/reactors/download_stream.h"

namespace pleat {

grpc::ServerWriteReactor<v1::DownloadSequenceResponse>* DownloadSequence(
    HandlerContext* context, const v1::DownloadSequenceRequest& request) {
  SequenceService* sequences = context->sequences;
  return StartDownload<v1::DownloadSequenceResponse>(
      context, request.id(), request.offset_bytes(),
      {.rpc = "DownloadSequence",
       .open = [sequences](const std::string& id, uint64_t offset_bytes) {
         return sequences->OpenDownload(id, offset_bytes);
       }});
}

}  // namespace pleat
