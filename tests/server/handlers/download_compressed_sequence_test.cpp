#include "pleat/v1/compressed_sequence_service.grpc.pb.h"
#include "server/handlers/transfer_suites.h"

namespace pleat {
namespace {

struct DownloadCompressedSequenceCase {
  using Request = v1::DownloadCompressedSequenceRequest;
  using Response = v1::DownloadCompressedSequenceResponse;
  static auto& Mock(MockService& service) { return service.mock_compressed_sequences; }
  static auto Download(const std::shared_ptr<grpc::Channel>& channel, grpc::ClientContext* call,
                       const Request& request) {
    return v1::CompressedSequenceService::NewStub(channel)->DownloadCompressedSequence(call,
                                                                                       request);
  }
};
INSTANTIATE_TYPED_TEST_SUITE_P(DownloadCompressedSequence, DownloadHandlerTest,
                               DownloadCompressedSequenceCase);

}  // namespace
}  // namespace pleat
