#include "pleat/v1/model_service.grpc.pb.h"
#include "server/handlers/transfer_suites.h"

namespace pleat {
namespace {

struct DownloadModelCase {
  using Request = v1::DownloadModelRequest;
  using Response = v1::DownloadModelResponse;
  static auto& Mock(MockService& service) { return service.mock_models; }
  static auto Download(const std::shared_ptr<grpc::Channel>& channel, grpc::ClientContext* call,
                       const Request& request) {
    return v1::ModelService::NewStub(channel)->DownloadModel(call, request);
  }
};
INSTANTIATE_TYPED_TEST_SUITE_P(DownloadModel, DownloadHandlerTest, DownloadModelCase);

}  // namespace
}  // namespace pleat
