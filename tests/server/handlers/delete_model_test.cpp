#include "server/handlers/handler_suites.h"

namespace pleat {
namespace {

using DeleteModelCase = HandlerCase<DeleteModel, &MockContext::models>;
INSTANTIATE_TYPED_TEST_SUITE_P(DeleteModel, DeleteHandlerTest, DeleteModelCase);

}  // namespace
}  // namespace pleat
