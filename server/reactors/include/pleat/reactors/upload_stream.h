// Uploads of files in chunks, whatever the files are.
#pragma once

#include <grpcpp/support/server_callback.h>

#include <functional>
#include <memory>
#include <string>
#include <utility>

#include "absl/strings/str_cat.h"
#include "pleat/base/status.h"
#include "pleat/reactors/grpc_status.h"
#include "pleat/reactors/handler_context.h"
#include "pleat/reactors/run_unary.h"
#include "pleat/v1/sequence_service.pb.h"
#include "pleat/wire/skeleton_messages.h"

namespace pleat {

// What differs between uploads. Both fill the response.
template <typename Response>
struct UploadTarget {
  const char* rpc;
  // OK when the content is already stored: the call then ends early. kNotFound: it is not.
  std::function<absl::Status(const std::string& id, Response*)> find;
  // Checks and stores the complete upload.
  std::function<absl::Status(Upload*, Response*)> finish;
};

// Exactly one thing is under way until the call is finished: a read or a task on the executor.
template <typename Response>
class UploadStream final : public grpc::ServerReadReactor<v1::UploadSequenceRequest> {
 public:
  UploadStream(HandlerContext* context, Response* response, UploadTarget<Response> target)
      : slot_(context), context_(context), response_(response), target_(std::move(target)) {
    StartRead(&request_);
  }

  void OnReadDone(bool ok) override {
    context_->storage_executor->Post([this, ok] {
      bool finished = !ok;
      const absl::Status status =
          CallGuarded([&] { return ok ? TakePart(&finished) : Complete(); });
      if (status.ok() && !finished) {
        StartRead(&request_);
        return;
      }
      LogFailure(target_.rpc, status);
      upload_.reset();  // the right to write, before the client can ask for it again
      Finish(ToGrpcStatus(status));
    });
  }
  void OnCancel() override {}  // the read ends with ok = false
  void OnDone() override { delete this; }

 private:
  static constexpr size_t kMaxChunkBytes = 2 << 20;

  absl::Status TakePart(bool* finished) {
    if (upload_ == nullptr) return TakeHeader(finished);
    const std::string& data = request_.data();
    if (request_.part_case() != v1::UploadSequenceRequest::kData || data.empty() ||
        data.size() > kMaxChunkBytes) {
      return absl::InvalidArgumentError(
          absl::StrCat("after the header, every message of an upload carries 1 to ", kMaxChunkBytes,
                       " bytes of data"));
    }
    return upload_->Append(data);
  }

  absl::Status TakeHeader(bool* finished) {
    PLEAT_RETURN_IF_ERROR(slot_.status());
    if (request_.part_case() != v1::UploadSequenceRequest::kHeader) {
      return absl::InvalidArgumentError("the first message of an upload must be its header");
    }
    const v1::UploadSequenceRequest::Header& header = request_.header();
    PLEAT_RETURN_IF_ERROR(CheckContentId(header.id(), "header.id"));
    if (target_.find(header.id(), response_).ok()) {
      *finished = true;
      return absl::OkStatus();
    }
    PLEAT_ASSIGN_OR_RETURN(upload_, context_->service->BeginUpload(header.id(), header.size_bytes(),
                                                                   header.offset_bytes()));
    return absl::OkStatus();
  }

  absl::Status Complete() {
    if (upload_ == nullptr) {
      return absl::InvalidArgumentError("the upload ended before its header");
    }
    return target_.finish(upload_.get(), response_);
  }

  StreamSlot slot_;
  HandlerContext* context_;
  Response* response_;
  const UploadTarget<Response> target_;
  v1::UploadSequenceRequest request_;
  std::unique_ptr<Upload> upload_;
};

}  // namespace pleat
