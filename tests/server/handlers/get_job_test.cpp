#include "server/handlers/handler_checks.h"

namespace pleat {
namespace {

absl::Status Ask(MockContext& mock, v1::GetJobResponse* response) {
  v1::GetJobRequest request;
  request.set_id("job-1");
  return GetJob(mock.context, request, response);
}

TEST(GetJob, SaysWhereTheJobStands) {
  MockContext mock;
  JobInfo info;
  info.id = "job-1";
  info.state = JobState::kFailed;
  info.stage = "rig";
  info.fraction = .25;
  info.error = absl::FailedPreconditionError("no human-like rig fits");
  EXPECT_CALL(mock.jobs, Get("job-1")).WillOnce(testing::Return(info));
  v1::GetJobResponse response;
  ASSERT_THAT(Ask(mock, &response), IsOk());
  EXPECT_EQ(response.job().id(), "job-1");
  EXPECT_EQ(response.job().state(), v1::JOB_STATE_FAILED);
  EXPECT_EQ(response.job().stage(), "rig");
  EXPECT_EQ(response.job().fraction(), .25);
  EXPECT_EQ(response.job().error().code(), 9);
  EXPECT_EQ(response.job().error().message(), "no human-like rig fits");
}

TEST(GetJob, PassesOnThatThereIsNone) {
  MockContext mock;
  EXPECT_CALL(mock.jobs, Get("job-1")).WillOnce(testing::Return(absl::NotFoundError("none")));
  v1::GetJobResponse response;
  EXPECT_THAT(Ask(mock, &response), HasStatus(absl::StatusCode::kNotFound, "none"));
}

}  // namespace
}  // namespace pleat
