#include "server/handlers/handler_suites.h"

namespace pleat {
namespace {

using DeleteSequenceCase = HandlerCase<DeleteSequence, &MockContext::sequences>;
INSTANTIATE_TYPED_TEST_SUITE_P(DeleteSequence, DeleteHandlerTest, DeleteSequenceCase);

}  // namespace
}  // namespace pleat
