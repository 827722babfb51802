#include "server/handlers/handler_suites.h"

namespace pleat {
namespace {

using PinCompressedSequenceCase =
    HandlerCase<PinCompressedSequence, &MockContext::compressed_sequences>;
INSTANTIATE_TYPED_TEST_SUITE_P(PinCompressedSequence, PinHandlerTest, PinCompressedSequenceCase);

}  // namespace
}  // namespace pleat
