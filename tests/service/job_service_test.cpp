#include "pleat/service/job_service.h"

#include <gtest/gtest.h>

#include "support/mock_services.h"
#include "support/scripted_jobs.h"
#include "support/status_matchers.h"

namespace pleat {
namespace {

using ::testing::_;
using ::testing::ElementsAre;

JobInfo Job(JobState state) {
  JobInfo job;
  job.id = "job-1";
  job.state = state;
  return job;
}

class WatchJobTest : public testing::Test {
 protected:
  // The states that an observer sees who stops at `last`.
  absl::Status Watch(std::vector<JobInfo> script, JobState last) {
    EXPECT_CALL(jobs_, Subscribe("job-1", _))
        .WillOnce([script](const std::string&, std::function<void()> listener) {
          return std::make_unique<ScriptedSubscription>(
              script, absl::UnavailableError("shutting down"), std::move(listener));
        });
    return WatchJob(jobs_, "job-1", [&](const JobInfo& job) {
      seen_.push_back(job.state);
      return job.state != last;
    });
  }

  testing::StrictMock<MockJobService> jobs_;
  std::vector<JobState> seen_;
};

TEST(JobState, ThreeAreFinal) {
  EXPECT_FALSE(IsFinal(JobState::kQueued));
  EXPECT_FALSE(IsFinal(JobState::kRunning));
  EXPECT_TRUE(IsFinal(JobState::kSucceeded));
  EXPECT_TRUE(IsFinal(JobState::kFailed));
  EXPECT_TRUE(IsFinal(JobState::kCancelled));
  EXPECT_STREQ(JobStateName(JobState::kRunning), "running");
}

TEST_F(WatchJobTest, EndsWithTheFinalState) {
  EXPECT_THAT(Watch({Job(JobState::kQueued), Job(JobState::kRunning), Job(JobState::kFailed)},
                    JobState::kFailed),
              IsOk());
  EXPECT_THAT(seen_, ElementsAre(JobState::kQueued, JobState::kRunning, JobState::kFailed));
}

TEST_F(WatchJobTest, AJobThatIsFinalIsSeenOnce) {
  EXPECT_THAT(Watch({Job(JobState::kSucceeded)}, JobState::kQueued), IsOk());
  EXPECT_THAT(seen_, ElementsAre(JobState::kSucceeded));
}

TEST_F(WatchJobTest, EndsWhenTheObserverHasSeenEnough) {
  EXPECT_THAT(Watch({Job(JobState::kQueued), Job(JobState::kRunning), Job(JobState::kSucceeded)},
                    JobState::kRunning),
              IsOk());
  EXPECT_THAT(seen_, ElementsAre(JobState::kQueued, JobState::kRunning));
}

TEST_F(WatchJobTest, ASubscriptionThatEndsIsAnErrorAfterTheLastNews) {
  EXPECT_THAT(Watch({Job(JobState::kQueued), Job(JobState::kRunning)}, JobState::kFailed),
              HasStatus(absl::StatusCode::kUnavailable, "shutting down"));
  EXPECT_EQ(seen_.back(), JobState::kRunning);
}

TEST_F(WatchJobTest, PassesOnThatThereIsNone) {
  EXPECT_CALL(jobs_, Subscribe)
      .WillOnce(testing::Return(testing::ByMove(absl::NotFoundError("none"))));
  EXPECT_THAT(WatchJob(jobs_, "job-1", [](const JobInfo&) { return true; }),
              HasStatus(absl::StatusCode::kNotFound, "none"));
}

}  // namespace
}  // namespace pleat
