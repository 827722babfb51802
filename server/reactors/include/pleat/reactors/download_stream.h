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
#include "pleat/service/content_download.h"

namespace pleat {

// What makes one kind of download different from another.
struct DownloadSource {
  const char* rpc;
  // Opens the file `id`; kNotFound when there is none.
  std::function<absl::StatusOr<std::unique_ptr<ContentDownload>>(const std::string& id,
                                                                 uint64_t offset_bytes)>
      open;
};

// Sends the file from `offset_bytes` on. Response has the fields size_bytes, offset_bytes and data.
// A download that has sent something goes to its end, also when the file is deleted meanwhile.
template <typename Response>
grpc::ServerWriteReactor<Response>* StartDownload(HandlerContext* context, const std::string& id,
                                                  uint64_t offset_bytes, DownloadSource source) {
  struct Download {
    DownloadSource source;
    std::string id;
    uint64_t offset_bytes;
    std::unique_ptr<ContentDownload> file;

    absl::StatusOr<bool> Next(Response* response) {
      if (file == nullptr) {
        PLEAT_RETURN_IF_ERROR(CheckContentId(id, "id"));
        PLEAT_ASSIGN_OR_RETURN(file, source.open(id, offset_bytes));
      } else if (offset_bytes == file->size_bytes()) {
        return false;
      }
      PLEAT_ASSIGN_OR_RETURN(*response->mutable_data(), file->Next());
      response->set_size_bytes(file->size_bytes());
      response->set_offset_bytes(offset_bytes);
      offset_bytes += response->data().size();
      if (response->data().empty() && offset_bytes < file->size_bytes()) {
        return absl::DataLossError("the stored file is cut off");
      }
      return true;
    }
  };
  const char* rpc = source.rpc;
  const auto download =
      std::make_shared<Download>(Download{std::move(source), id, offset_bytes, nullptr});
  return StartReactor<PullStream<Response>>(
      context, context->transfer_executor, rpc,
      [download](Response* response) { return download->Next(response); });
}

}  // namespace pleat
