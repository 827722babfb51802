#include "pleat/v1/compressed_sequence_service.grpc.pb.h"
#include "server/handlers/transfer_suites.h"

namespace pleat {
namespace {

struct UploadCompressedSequenceCase {
  using Info = CompressedSequenceInfo;
  using Response = v1::UploadCompressedSequenceResponse;
  static auto& Mock(MockService& service) { return service.mock_compressed_sequences; }
  static auto Upload(const std::shared_ptr<grpc::Channel>& channel, grpc::ClientContext* call,
                     Response* response) {
    return v1::CompressedSequenceService::NewStub(channel)->UploadCompressedSequence(call,
                                                                                     response);
  }
  static const std::string& Id(const Response& response) {
    return response.compressed_sequence().id();
  }
};
INSTANTIATE_TYPED_TEST_SUITE_P(UploadCompressedSequence, UploadHandlerTest,
                               UploadCompressedSequenceCase);

}  // namespace
}  // namespace pleat
