// The upload of a file in chunks, whatever the file is.
#pragma once

#include <grpcpp/support/server_callback.h>

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <utility>

#include "absl/strings/str_cat.h"
#include "pleat/base/content_id.h"
#include "pleat/base/status.h"
#include "pleat/reactors/call_reactor.h"
#include "pleat/reactors/grpc_status.h"
#include "pleat/reactors/handler_context.h"
#include "pleat/reactors/run_unary.h"
#include "pleat/service/content_upload.h"
#include "pleat/service/limits.h"
#include "pleat/v1/sequence_service.pb.h"

namespace pleat {

// What makes one kind of upload different from another. Info is what the service says about the
// stored file.
template <typename Info, typename Response>
struct UploadTarget {
  const char* rpc;
  // When the upload is complete already, the call ends early.
  std::function<absl::StatusOr<std::unique_ptr<ContentUpload<Info>>>(
      const v1::UploadSequenceRequest::Header& header)>
      begin;
  std::function<void(const Info&, Response*)> reply;
};

// A piece that waits for its task, and one that gRPC reads meanwhile.
inline constexpr uint64_t kUploadStreamBytes = 2 * kMaxUploadChunkBytes;

// Sequential (call_reactor.h): until the call is finished, either a read or a task is under way.
template <typename Info, typename Response>
class UploadStream final : public CallReactor<grpc::ServerReadReactor<v1::UploadSequenceRequest>> {
 public:
  UploadStream(HandlerContext* context, Response* response, UploadTarget<Info, Response> target)
      : CallReactor(context),
        slot_(context, kStreamBytes + kUploadStreamBytes),
        context_(context),
        response_(response),
        target_(std::move(target)) {}

  void Start() { StartRead(&request_); }
  void OnReadDone(bool ok) override {
    // Such a message is never looked at. Let go of it here, for the task may have to wait.
    if (ok && request_.data().size() > kMaxUploadChunkBytes) {
      v1::UploadSequenceRequest small;
      small.set_data("");
      request_.Swap(&small);
    }
    Post(context_->transfer_executor, [this, ok] {
      bool finished = !ok;
      const absl::Status status =
          CallGuarded([&] { return ok ? TakePart(&finished) : Complete(); });
      if (status.ok() && !finished) {
        StartRead(&request_);
        return;
      }
      LogFailure(target_.rpc, status);
      upload_.reset();  // the right to write: the client may ask for it again right away
      Finish(ToGrpcStatus(status));
    });
  }
  void OnCancel() override {}  // the read ends with ok = false

 private:
  absl::Status TakePart(bool* finished) {
    if (upload_ == nullptr) return TakeHeader(finished);
    const std::string& data = request_.data();
    if (request_.part_case() != v1::UploadSequenceRequest::kData || data.empty() ||
        data.size() > kMaxUploadChunkBytes) {
      return absl::InvalidArgumentError(
          absl::StrCat("after the header, every message of an upload carries 1 to ",
                       kMaxUploadChunkBytes, " bytes of data"));
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
    PLEAT_ASSIGN_OR_RETURN(upload_, target_.begin(header));
    *finished = upload_->complete();
    return *finished ? Complete() : absl::OkStatus();
  }

  absl::Status Complete() {
    if (upload_ == nullptr) {
      return absl::InvalidArgumentError("the upload ended before its header");
    }
    PLEAT_ASSIGN_OR_RETURN(const Info info, upload_->Finish());
    target_.reply(info, response_);
    return absl::OkStatus();
  }

  StreamSlot slot_;
  HandlerContext* context_;
  Response* response_;
  const UploadTarget<Info, Response> target_;
  v1::UploadSequenceRequest request_;
  std::unique_ptr<ContentUpload<Info>> upload_;
};

}  // namespace pleat
