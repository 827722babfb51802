#include "server/handlers/handler_suites.h"

namespace pleat {
namespace {

struct ListJobsCase : HandlerCase<ListJobs, &MockContext::jobs> {
  static const auto& Items(const Response& response) { return response.jobs(); }
};
INSTANTIATE_TYPED_TEST_SUITE_P(ListJobs, ListHandlerTest, ListJobsCase);

}  // namespace
}  // namespace pleat
