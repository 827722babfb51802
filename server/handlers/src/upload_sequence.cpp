#include <memory>
#include <string>

#include "absl/strings/str_cat.h"
#include "grpc_status.h"
#include "pleat/base/status.h"
#include "pleat/wire/service_messages.h"
#include "pleat/wire/skeleton_messages.h"
#include "run_unary.h"
#include "stream_handlers.h"

namespace pleat {
namespace {

constexpr size_t kMaxChunkBytes = 2 << 20;

// Exactly one thing is under way until the call is finished: a read or a task on the executor.
class UploadReactor final : public grpc::ServerReadReactor<v1::UploadSequenceRequest> {
 public:
  UploadReactor(HandlerContext* context, v1::UploadSequenceResponse* response)
      : slot_(context), context_(context), response_(response) {
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
      LogFailure("UploadSequence", status);
      upload_.reset();  // the right to write, before the client can ask for it again
      Finish(ToGrpcStatus(status));
    });
  }
  void OnCancel() override {}  // the read ends with ok = false
  void OnDone() override { delete this; }

 private:
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
    const absl::StatusOr<SequenceInfo> stored = context_->service->GetSequence(header.id());
    if (stored.ok()) {  // the same content is already here
      *response_->mutable_sequence() = ToProto(*stored);
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
    PLEAT_ASSIGN_OR_RETURN(const SequenceInfo info, context_->service->FinishUpload(upload_.get()));
    *response_->mutable_sequence() = ToProto(info);
    return absl::OkStatus();
  }

  StreamSlot slot_;
  HandlerContext* context_;
  v1::UploadSequenceResponse* response_;
  v1::UploadSequenceRequest request_;
  std::unique_ptr<Upload> upload_;
};

}  // namespace

grpc::ServerReadReactor<v1::UploadSequenceRequest>* UploadSequence(
    HandlerContext* context, v1::UploadSequenceResponse* response) {
  return new UploadReactor(context, response);
}

}  // namespace pleat
