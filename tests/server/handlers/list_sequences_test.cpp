#include "server/handlers/handler_suites.h"

namespace pleat {
namespace {

struct ListSequencesCase : HandlerCase<ListSequences, &MockContext::sequences> {
  static const auto& Items(const Response& response) { return response.sequences(); }
};
INSTANTIATE_TYPED_TEST_SUITE_P(ListSequences, ListHandlerTest, ListSequencesCase);

}  // namespace
}  // namespace pleat
