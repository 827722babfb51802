#include "server/handlers/handler_suites.h"

namespace pleat {
namespace {

struct GetSequenceCase : HandlerCase<GetSequence, &MockContext::sequences> {
  static const auto& Item(const Response& response) { return response.sequence(); }
};
INSTANTIATE_TYPED_TEST_SUITE_P(GetSequence, GetHandlerTest, GetSequenceCase);

}  // namespace
}  // namespace pleat
