// Downloads of stored files in chunks, whatever the files are.
#pragma once

#include <memory>
#include <string>
#include <utility>

#include "pleat/base/status.h"
#include "pleat/reactors/pull_stream.h"
#include "pleat/wire/skeleton_messages.h"

namespace pleat {

inline constexpr uint64_t kDownloadChunkBytes = 512 << 10;

// Response: has size_bytes, offset_bytes and data. size_of: the size of the file `id`, or
// kNotFound.
template <typename Response>
grpc::ServerWriteReactor<Response>* StartDownload(
    HandlerContext* context, const char* rpc, EntryKind kind, const std::string& id,
    uint64_t offset_bytes, std::function<absl::StatusOr<uint64_t>(const std::string& id)> size_of) {
  struct Download {
    LocalCharacterService* service;
    EntryKind kind;
    std::string id;
    uint64_t offset_bytes;
    std::function<absl::StatusOr<uint64_t>(const std::string& id)> size_of;
    uint64_t size_bytes = 0;

    absl::StatusOr<bool> Next(Response* response) {
      if (size_bytes == 0) {
        PLEAT_RETURN_IF_ERROR(CheckContentId(id, "id"));
        PLEAT_ASSIGN_OR_RETURN(size_bytes, size_of(id));
      } else if (offset_bytes == size_bytes) {
        return false;
      }
      PLEAT_ASSIGN_OR_RETURN(*response->mutable_data(),
                             service->ReadStoredBytes(kind, id, offset_bytes, kDownloadChunkBytes));
      response->set_size_bytes(size_bytes);
      response->set_offset_bytes(offset_bytes);
      offset_bytes += response->data().size();
      if (response->data().empty() && offset_bytes < size_bytes) {
        return absl::DataLossError("the stored file is cut off");
      }
      return true;
    }
  };
  const auto download = std::make_shared<Download>(
      Download{context->service, kind, id, offset_bytes, std::move(size_of)});
  return new PullStream<Response>(
      context, context->storage_executor, rpc,
      [download](Response* response) { return download->Next(response); });
}

}  // namespace pleat
