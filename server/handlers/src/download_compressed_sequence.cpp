#include "pleat/handlers/stream_handlers.h"
#include "pleat/reactors/download_stream.h"

namespace pleat {

grpc::ServerWriteReactor<v1::DownloadCompressedSequenceResponse>* DownloadCompressedSequence(
    HandlerContext* context, const v1::DownloadCompressedSequenceRequest& request) {
  return StartDownload<v1::DownloadCompressedSequenceResponse>(
      context, "DownloadCompressedSequence", EntryKind::kCompressedSequence, request.id(),
      request.offset_bytes(),
      [service = context->service](const std::string& id) -> absl::StatusOr<uint64_t> {
        PLEAT_ASSIGN_OR_RETURN(const CompressedSequenceInfo info,
                               service->GetCompressedSequence(id));
        return info.size_bytes;
      });
}

}  // namespace pleat
