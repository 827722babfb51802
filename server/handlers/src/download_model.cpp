#include "pleat/handlers/stream_handlers.h"
#include "pleat/reactors/download_stream.h"

namespace pleat {

grpc::ServerWriteReactor<v1::DownloadModelResponse>* DownloadModel(
    HandlerContext* context, const v1::DownloadModelRequest& request) {
  return StartDownload<v1::DownloadModelResponse>(
      context, "DownloadModel", EntryKind::kModel, request.id(), request.offset_bytes(),
      [service = context->service](const std::string& id) -> absl::StatusOr<uint64_t> {
        PLEAT_ASSIGN_OR_RETURN(const ModelInfo info, service->GetModel(id));
        return info.size_bytes;
      });
}

}  // namespace pleat
