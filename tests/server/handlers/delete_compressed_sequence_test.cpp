#include "server/handlers/handler_suites.h"

namespace pleat {
namespace {

INSTANTIATE_TYPED_TEST_SUITE_P(
    DeleteCompressedSequence, DeleteHandlerTest,
    HandlerCase<DeleteCompressedSequence, &MockContext::compressed_sequences>);

}  // namespace
}  // namespace pleat
