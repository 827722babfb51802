#include "pleat/handlers/stream_handlers.h"
#include "pleat/reactors/download_stream.h"

namespace pleat {

grpc::ServerWriteReactor<v1::DownloadModelResponse>* DownloadModel(
    HandlerContext* context, const v1::DownloadModelRequest& request) {
  ModelService* models = context->models;
  return StartDownload<v1::DownloadModelResponse>(
      context, request.id(), request.offset_bytes(),
      {.rpc = "DownloadModel", .open = [models](const std::string& id, uint64_t offset_bytes) {
         return models->OpenDownload(id, offset_bytes);
       }});
}

}  // namespace pleat
