#include "pleat/v1/sequence_service.grpc.pb.h"
#include "server/handlers/transfer_suites.h"

namespace pleat {
namespace {

struct UploadSequenceCase {
  using Info = SequenceInfo;
  using Response = v1::UploadSequenceResponse;
  static auto& Mock(MockService& service) { return service.mock_sequences; }
  static auto Upload(const std::shared_ptr<grpc::Channel>& channel, grpc::ClientContext* call,
                     Response* response) {
    return v1::SequenceService::NewStub(channel)->UploadSequence(call, response);
  }
  static const std::string& Id(const Response& response) { return response.sequence().id(); }
};
INSTANTIATE_TYPED_TEST_SUITE_P(UploadSequence, UploadHandlerTest, UploadSequenceCase);

}  // namespace
}  // namespace pleat
