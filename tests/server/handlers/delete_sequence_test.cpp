#include "server/handlers/handler_suites.h"

namespace pleat {
namespace {

INSTANTIATE_TYPED_TEST_SUITE_P(DeleteSequence, DeleteHandlerTest,
                               HandlerCase<DeleteSequence, &MockContext::sequences>);

}  // namespace
}  // namespace pleat
