#include "server/handlers/handler_suites.h"

namespace pleat {
namespace {

using PinModelCase = HandlerCase<PinModel, &MockContext::models>;
INSTANTIATE_TYPED_TEST_SUITE_P(PinModel, PinHandlerTest, PinModelCase);

}  // namespace
}  // namespace pleat
