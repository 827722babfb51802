#include "server/handlers/handler_suites.h"

namespace pleat {
namespace {

struct GetModelCase : HandlerCase<GetModel, &MockContext::models> {
  static const auto& Item(const Response& response) { return response.model(); }
};
INSTANTIATE_TYPED_TEST_SUITE_P(GetModel, GetHandlerTest, GetModelCase);

}  // namespace
}  // namespace pleat
