#include "server/handlers/handler_checks.h"

namespace pleat {
namespace {

TEST(DeleteJob, PassesOnHowItEnded) {
  MockContext mock;
  EXPECT_CALL(mock.jobs, Delete("job-1"))
      .WillOnce(testing::Return(absl::OkStatus()))
      .WillOnce(testing::Return(absl::FailedPreconditionError("the job is running")));
  v1::DeleteJobRequest request;
  v1::DeleteJobResponse response;
  request.set_id("job-1");
  EXPECT_THAT(DeleteJob(mock.context, request, &response), IsOk());
  EXPECT_THAT(DeleteJob(mock.context, request, &response),
              HasStatus(absl::StatusCode::kFailedPrecondition, "the job is running"));
}

}  // namespace
}  // namespace pleat
