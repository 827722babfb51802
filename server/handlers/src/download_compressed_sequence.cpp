#include "pleat/base/status.h"
#include "pleat/handlers/stream_handlers.h"
#include "pleat/reactors/download_stream.h"

namespace pleat {

grpc::ServerWriteReactor<v1::DownloadCompressedSequenceResponse>* DownloadCompressedSequence(
    HandlerContext* context, const v1::DownloadCompressedSequenceRequest& request) {
  CompressedSequenceService* compressed = context->compressed_sequences;
  return StartDownload<v1::DownloadCompressedSequenceResponse>(
      context, request.id(), request.offset_bytes(),
      {.rpc = "DownloadCompressedSequence",
       .size_of = [compressed](const std::string& id) -> absl::StatusOr<uint64_t> {
         PLEAT_ASSIGN_OR_RETURN(const CompressedSequenceInfo info, compressed->Get(id));
         return info.size_bytes;
       },
       .read = [compressed](const std::string& id, uint64_t offset,
                            uint64_t count) { return compressed->ReadBytes(id, offset, count); }});
}

}  // namespace pleat
