#include <memory>
#include <string>

#include "pleat/base/status.h"
#include "pleat/wire/skeleton_messages.h"
#include "pull_stream.h"
#include "stream_handlers.h"

namespace pleat {
namespace {

constexpr uint64_t kChunkBytes = 512 << 10;

struct Download {
  LocalCharacterService* service;
  std::string id;
  uint64_t offset_bytes;
  uint64_t size_bytes = 0;

  absl::StatusOr<bool> Next(v1::DownloadModelResponse* response) {
    if (size_bytes == 0) {
      PLEAT_RETURN_IF_ERROR(CheckContentId(id, "id"));
      PLEAT_ASSIGN_OR_RETURN(const ModelInfo info, service->GetModel(id));
      size_bytes = info.size_bytes;
    } else if (offset_bytes == size_bytes) {
      return false;
    }
    PLEAT_ASSIGN_OR_RETURN(*response->mutable_data(),
                           service->ReadModelBytes(id, offset_bytes, kChunkBytes));
    response->set_size_bytes(size_bytes);
    response->set_offset_bytes(offset_bytes);
    offset_bytes += response->data().size();
    if (response->data().empty() && offset_bytes < size_bytes) {
      return absl::DataLossError("the model's file is cut off");
    }
    return true;
  }
};

}  // namespace

grpc::ServerWriteReactor<v1::DownloadModelResponse>* DownloadModel(
    HandlerContext* context, const v1::DownloadModelRequest& request) {
  const auto download =
      std::make_shared<Download>(Download{context->service, request.id(), request.offset_bytes()});
  return new PullStream<v1::DownloadModelResponse>(
      context, context->storage_executor, "DownloadModel",
      [download](v1::DownloadModelResponse* response) { return download->Next(response); });
}

}  // namespace pleat
