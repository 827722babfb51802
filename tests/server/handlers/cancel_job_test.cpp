#include "server/handlers/handler_checks.h"

namespace pleat {
namespace {

TEST(CancelJob, PassesOnHowItEnded) {
  MockContext mock;
  EXPECT_CALL(mock.jobs, Cancel("job-1"))
      .WillOnce(testing::Return(absl::OkStatus()))
      .WillOnce(testing::Return(absl::FailedPreconditionError("the job is cancelled")));
  v1::CancelJobRequest request;
  v1::CancelJobResponse response;
  request.set_id("job-1");
  EXPECT_THAT(CancelJob(mock.context, request, &response), IsOk());
  EXPECT_THAT(CancelJob(mock.context, request, &response),
              HasStatus(absl::StatusCode::kFailedPrecondition, "the job is cancelled"));
}

}  // namespace
}  // namespace pleat
