#include "server/handlers/handler_suites.h"

namespace pleat {
namespace {

struct GetCompressedSequenceCase
    : HandlerCase<GetCompressedSequence, &MockContext::compressed_sequences> {
  static const auto& Item(const Response& response) { return response.compressed_sequence(); }
};
INSTANTIATE_TYPED_TEST_SUITE_P(GetCompressedSequence, GetHandlerTest, GetCompressedSequenceCase);

}  // namespace
}  // namespace pleat
