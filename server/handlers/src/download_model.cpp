#include "pleat/base/status.h"
#include "pleat/handlers/stream_handlers.h"
#include "pleat/reactors/download_stream.h"

namespace pleat {

grpc::ServerWriteReactor<v1::DownloadModelResponse>* DownloadModel(
    HandlerContext* context, const v1::DownloadModelRequest& request) {
  ModelService* models = context->models;
  return StartDownload<v1::DownloadModelResponse>(
      context, request.id(), request.offset_bytes(),
      {.rpc = "DownloadModel",
       .size_of = [models](const std::string& id) -> absl::StatusOr<uint64_t> {
         PLEAT_ASSIGN_OR_RETURN(const ModelInfo info, models->Get(id));
         return info.size_bytes;
       },
       .read = [models](const std::string& id, uint64_t offset,
                        uint64_t count) { return models->ReadBytes(id, offset, count); }});
}

}  // namespace pleat
