// The download of a stored file in chunks, whatever the file is.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <utility>

#include "pleat/base/content_id.h"
#include "pleat/base/status.h"
#include "pleat/reactors/pull_stream.h"

namespace pleat {

inline constexpr uint64_t kDownloadChunkBytes = 512 << 10;

// What makes one kind of download different from another.
struct DownloadSource {
  const char* rpc;
  // Gives the size of the file `id`, or kNotFound.
  std::function<absl::StatusOr<uint64_t>(const std::string& id)> size_of;
  // Gives `count` bytes of the file from `offset`, fewer at its end.
  std::function<absl::StatusOr<std::string>(const std::string& id, uint64_t offset, uint64_t count)>
      read;
};

// Sends the file from `offset_bytes` on. Response has the fields size_bytes, offset_bytes and data.
template <typename Response>
grpc::ServerWriteReactor<Response>* StartDownload(HandlerContext* context, const std::string& id,
                                                  uint64_t offset_bytes, DownloadSource source) {
  struct Download {
    DownloadSource source;
    std::string id;
    uint64_t offset_bytes;
    uint64_t size_bytes = 0;

    absl::StatusOr<bool> Next(Response* response) {
      if (size_bytes == 0) {
        PLEAT_RETURN_IF_ERROR(CheckContentId(id, "id"));
        PLEAT_ASSIGN_OR_RETURN(size_bytes, source.size_of(id));
      } else if (offset_bytes == size_bytes) {
        return false;
      }
      PLEAT_ASSIGN_OR_RETURN(*response->mutable_data(),
                             source.read(id, offset_bytes, kDownloadChunkBytes));
      response->set_size_bytes(size_bytes);
      response->set_offset_bytes(offset_bytes);
      offset_bytes += response->data().size();
      if (response->data().empty() && offset_bytes < size_bytes) {
        return absl::DataLossError("the stored file is cut off");
      }
      return true;
    }
  };
  const char* rpc = source.rpc;
  const auto download = std::make_shared<Download>(Download{std::move(source), id, offset_bytes});
  return StartReactor<PullStream<Response>>(
      context, context->transfer_executor, rpc,
      [download](Response* response) { return download->Next(response); });
}

}  // namespace pleat
