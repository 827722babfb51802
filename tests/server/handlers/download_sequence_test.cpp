#include "pleat/v1/sequence_service.grpc.pb.h"
#include "server/handlers/transfer_suites.h"

namespace pleat {
namespace {

struct DownloadSequenceCase {
  using Request = v1::DownloadSequenceRequest;
  using Response = v1::DownloadSequenceResponse;
  static auto& Mock(MockService& service) { return service.mock_sequences; }
  static auto Download(const std::shared_ptr<grpc::Channel>& channel, grpc::ClientContext* call,
                       const Request& request) {
    return v1::SequenceService::NewStub(channel)->DownloadSequence(call, request);
  }
};
INSTANTIATE_TYPED_TEST_SUITE_P(DownloadSequence, DownloadHandlerTest, DownloadSequenceCase);

}  // namespace
}  // namespace pleat
