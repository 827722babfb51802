#include "server/handlers/handler_suites.h"

namespace pleat {
namespace {

struct ListModelsCase : HandlerCase<ListModels, &MockContext::models> {
  static const auto& Items(const Response& response) { return response.models(); }
};
INSTANTIATE_TYPED_TEST_SUITE_P(ListModels, ListHandlerTest, ListModelsCase);

}  // namespace
}  // namespace pleat
