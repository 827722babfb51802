#include "pleat/v1/job_service.grpc.pb.h"
#include "server/handlers/mock_server.h"
#include "support/scripted_jobs.h"

namespace pleat {
namespace {

using ::testing::HasSubstr;

class WatchJobTest : public testing::Test {
 protected:
  static JobInfo Job(JobState state, double fraction) {
    JobInfo job;
    job.id = "job-1";
    job.state = state;
    job.fraction = fraction;
    return job;
  }
  // The states that a client sees, the newest last.
  grpc::Status Watch(std::vector<v1::JobState>* states) {
    const auto stub = v1::JobService::NewStub(mock_.channel);
    v1::WatchJobRequest request;
    request.set_id("job-1");
    const auto reader = stub->WatchJob(&mock_.call, request);
    v1::WatchJobResponse response;
    while (reader->Read(&response)) states->push_back(response.job().state());
    return reader->Finish();
  }
  void ExpectSubscription(std::vector<JobInfo> script) {
    EXPECT_CALL(mock_.service.mock_jobs, Subscribe("job-1", testing::_))
        .WillOnce([script](const std::string&, std::function<void()> listener) {
          return std::make_unique<ScriptedSubscription>(
              script, absl::UnavailableError("the service is shutting down"), std::move(listener));
        });
  }

  MockServer mock_;
};

TEST_F(WatchJobTest, SendsTheJobUntilItIsFinal) {
  ExpectSubscription(
      {Job(JobState::kQueued, 0), Job(JobState::kRunning, .5), Job(JobState::kSucceeded, 1)});
  std::vector<v1::JobState> states;
  EXPECT_TRUE(Watch(&states).ok());
  ASSERT_FALSE(states.empty());
  EXPECT_EQ(states.front(), v1::JOB_STATE_QUEUED);
  EXPECT_EQ(states.back(), v1::JOB_STATE_SUCCEEDED);
}

TEST_F(WatchJobTest, AServiceThatShutsDownEndsTheWatch) {
  ExpectSubscription({Job(JobState::kRunning, .5)});
  std::vector<v1::JobState> states;
  EXPECT_THAT(Watch(&states),
              HasGrpcStatus(grpc::StatusCode::UNAVAILABLE, HasSubstr("watch the job again")));
  EXPECT_THAT(states, testing::ElementsAre(v1::JOB_STATE_RUNNING));
}

TEST_F(WatchJobTest, PassesOnThatThereIsNone) {
  EXPECT_CALL(mock_.service.mock_jobs, Subscribe)
      .WillOnce(testing::Return(testing::ByMove(absl::NotFoundError("no such job"))));
  std::vector<v1::JobState> states;
  EXPECT_THAT(Watch(&states), HasGrpcStatus(grpc::StatusCode::NOT_FOUND, "no such job"));
  EXPECT_TRUE(states.empty());
}

}  // namespace
}  // namespace pleat
