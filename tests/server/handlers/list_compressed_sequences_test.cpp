#include "server/handlers/handler_suites.h"

namespace pleat {
namespace {

struct ListCompressedSequencesCase
    : HandlerCase<ListCompressedSequences, &MockContext::compressed_sequences> {
  static const auto& Items(const Response& response) { return response.compressed_sequences(); }
};
INSTANTIATE_TYPED_TEST_SUITE_P(ListCompressedSequences, ListHandlerTest,
                               ListCompressedSequencesCase);

}  // namespace
}  // namespace pleat
