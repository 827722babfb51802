#include <memory>
#include <utility>

#include "pages.h"
#include "pleat/base/status.h"
#include "pleat/formats/sequence_file.h"
#include "pleat/wire/service_messages.h"
#include "remote_services.h"
#include "transfer.h"

namespace pleat {
namespace {

class RemoteSequences final : public SequenceService {
 public:
  explicit RemoteSequences(RemoteState* state) : state_(state) {}

  absl::StatusOr<SequenceInfo> Upload(const MeshSequence& sequence, const Progress& progress,
                                      absl::Duration ttl) override {
    const std::string bytes = EncodeSequence(sequence);
    return UploadFile(*state_, Calls(), {SequenceId(bytes), bytes.size(), ttl}, bytes, progress);
  }

  absl::StatusOr<SequenceInfo> Get(const std::string& id) override {
    v1::GetSequenceRequest request;
    v1::GetSequenceResponse response;
    request.set_id(id);
    PLEAT_RETURN_IF_ERROR(Call(&v1::SequenceService::Stub::GetSequence, request, &response));
    return FromProto(response.sequence());
  }

  absl::StatusOr<Page<SequenceInfo>> ListPage(const PageRequest& page) override {
    return ReadPage<SequenceInfo, v1::ListSequencesRequest, v1::ListSequencesResponse>(
        page,
        [this](const auto& request, auto* response) {
          return Call(&v1::SequenceService::Stub::ListSequences, request, response);
        },
        [](const auto& response) -> const auto& { return response.sequences(); });
  }

  absl::Status Delete(const std::string& id) override {
    v1::DeleteSequenceRequest request;
    v1::DeleteSequenceResponse response;
    request.set_id(id);
    return Call(&v1::SequenceService::Stub::DeleteSequence, request, &response);
  }

  absl::Status SetPinned(const std::string& id, bool pinned) override {
    v1::PinSequenceRequest request;
    v1::PinSequenceResponse response;
    request.set_id(id);
    request.set_pinned(pinned);
    return Call(&v1::SequenceService::Stub::PinSequence, request, &response);
  }

  absl::Status DeleteUpload(const std::string& id) override {
    v1::DeleteUploadRequest request;
    v1::DeleteUploadResponse response;
    request.set_id(id);
    return Call(&v1::SequenceService::Stub::DeleteUpload, request, &response);
  }

  absl::StatusOr<std::unique_ptr<ContentDownload>> OpenDownload(const std::string& id,
                                                                uint64_t offset_bytes) override {
    const StartDownload<v1::DownloadSequenceRequest, v1::DownloadSequenceResponse> start =
        [stub = state_->sequences.get()](grpc::ClientContext* context,
                                         const v1::DownloadSequenceRequest& request) {
          return stub->DownloadSequence(context, request);
        };
    return OpenRemoteDownload(state_->options, start, id, offset_bytes);
  }

  absl::StatusOr<UploadStatus> QueryUpload(const std::string& id) override {
    v1::QueryUploadRequest request;
    v1::QueryUploadResponse response;
    request.set_id(id);
    PLEAT_RETURN_IF_ERROR(Call(&v1::SequenceService::Stub::QueryUpload, request, &response));
    return UploadStatus{response.received_bytes(), response.complete()};
  }

  absl::StatusOr<std::unique_ptr<SequenceUpload>> BeginUpload(const std::string& id,
                                                              uint64_t size_bytes,
                                                              uint64_t offset_bytes,
                                                              absl::Duration ttl) override {
    return std::make_unique<RemoteUpload<SequenceInfo, v1::UploadSequenceResponse>>(
        Calls(), UploadedFile{id, size_bytes, ttl}, offset_bytes, Progress());
  }

 private:
  template <typename Request, typename Response>
  absl::Status Call(grpc::Status (v1::SequenceService::Stub::*method)(grpc::ClientContext*,
                                                                      const Request&, Response*),
                    const Request& request, Response* response) const {
    return state_->Call(state_->sequences.get(), method, request, response);
  }
  UploadCalls<SequenceInfo, v1::UploadSequenceResponse> Calls() const {
    return {.start =
                [stub = state_->sequences.get()](grpc::ClientContext* context,
                                                 v1::UploadSequenceResponse* response) {
                  return stub->UploadSequence(context, response);
                },
            .info_of =
                [](const v1::UploadSequenceResponse& response) {
                  return FromProto(response.sequence());
                }};
  }

  RemoteState* const state_;
};

}  // namespace

std::unique_ptr<SequenceService> MakeRemoteSequences(RemoteState* state) {
  return std::make_unique<RemoteSequences>(state);
}

}  // namespace pleat
