#include <memory>
#include <utility>

#include "pages.h"
#include "pleat/base/status.h"
#include "pleat/wire/service_messages.h"
#include "remote_services.h"
#include "transfer.h"

namespace pleat {
namespace {

class RemoteModels final : public ModelService {
 public:
  explicit RemoteModels(RemoteState* state) : state_(state) {}

  absl::StatusOr<ModelInfo> Get(const std::string& id) override {
    v1::GetModelRequest request;
    v1::GetModelResponse response;
    request.set_id(id);
    PLEAT_RETURN_IF_ERROR(Call(&v1::ModelService::Stub::GetModel, request, &response));
    return FromProto(response.model());
  }

  absl::StatusOr<Page<ModelInfo>> ListPage(const PageRequest& page) override {
    return ReadPage<ModelInfo, v1::ListModelsRequest, v1::ListModelsResponse>(
        page,
        [this](const auto& request, auto* response) {
          return Call(&v1::ModelService::Stub::ListModels, request, response);
        },
        [](const auto& response) -> const auto& { return response.models(); });
  }

  absl::Status Delete(const std::string& id) override {
    v1::DeleteModelRequest request;
    v1::DeleteModelResponse response;
    request.set_id(id);
    return Call(&v1::ModelService::Stub::DeleteModel, request, &response);
  }

  absl::Status SetPinned(const std::string& id, bool pinned) override {
    v1::PinModelRequest request;
    v1::PinModelResponse response;
    request.set_id(id);
    request.set_pinned(pinned);
    return Call(&v1::ModelService::Stub::PinModel, request, &response);
  }

  absl::StatusOr<std::string> Download(const std::string& id, const Progress& progress) override {
    return DownloadFile(*state_, id, progress, Start());
  }

  absl::StatusOr<std::unique_ptr<ContentDownload>> OpenDownload(const std::string& id,
                                                                uint64_t offset_bytes) override {
    return OpenRemoteDownload(state_->options, Start(), id, offset_bytes);
  }

 private:
  template <typename Request, typename Response>
  absl::Status Call(grpc::Status (v1::ModelService::Stub::*method)(grpc::ClientContext*,
                                                                   const Request&, Response*),
                    const Request& request, Response* response) const {
    return state_->Call(state_->models.get(), method, request, response);
  }
  StartDownload<v1::DownloadModelRequest, v1::DownloadModelResponse> Start() const {
    return [stub = state_->models.get()](grpc::ClientContext* context,
                                         const v1::DownloadModelRequest& request) {
      return stub->DownloadModel(context, request);
    };
  }

  RemoteState* const state_;
};

}  // namespace

std::unique_ptr<ModelService> MakeRemoteModels(RemoteState* state) {
  return std::make_unique<RemoteModels>(state);
}

}  // namespace pleat
