#include "server/handlers/handler_suites.h"

namespace pleat {
namespace {

using DeleteCompressedSequenceCase =
    HandlerCase<DeleteCompressedSequence, &MockContext::compressed_sequences>;
INSTANTIATE_TYPED_TEST_SUITE_P(DeleteCompressedSequence, DeleteHandlerTest,
                               DeleteCompressedSequenceCase);

}  // namespace
}  // namespace pleat
