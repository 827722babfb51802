#include "server/handlers/handler_suites.h"

namespace pleat {
namespace {

INSTANTIATE_TYPED_TEST_SUITE_P(DeleteModel, DeleteHandlerTest,
                               HandlerCase<DeleteModel, &MockContext::models>);

}  // namespace
}  // namespace pleat
