#include "server/handlers/handler_suites.h"

namespace pleat {
namespace {

using PinSequenceCase = HandlerCase<PinSequence, &MockContext::sequences>;
INSTANTIATE_TYPED_TEST_SUITE_P(PinSequence, PinHandlerTest, PinSequenceCase);

}  // namespace
}  // namespace pleat
