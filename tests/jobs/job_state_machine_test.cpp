#include "pleat/jobs/job_state_machine.h"

#include <gtest/gtest.h>

#include <thread>

#include "support/status_matchers.h"

namespace pleat {
namespace {

using ::testing::HasSubstr;

const absl::Time kNow = absl::FromUnixSeconds(1'800'000'000);

JobInfo Draft(JobState state = JobState::kQueued) {
  JobInfo info;
  info.id = "job-1";
  info.state = state;
  return info;
}

TEST(JobStateMachineTest, GoesTheDocumentedWay) {
  double now = 0;
  JobStateMachine job(Draft(), 0, [&] { return now; });
  EXPECT_FALSE(job.Succeed("m", {}, kNow));
  EXPECT_FALSE(job.Fail(absl::InternalError("x"), kNow));
  EXPECT_FALSE(job.Cancelled(kNow));
  EXPECT_FALSE(job.Requeue());
  ASSERT_TRUE(job.Start(kNow));
  EXPECT_FALSE(job.Start(kNow));
  EXPECT_EQ(job.snapshot().attempts, 1);
  ASSERT_TRUE(job.Succeed("model", {"look here"}, kNow));
  const JobInfo info = job.snapshot().info;
  EXPECT_EQ(info.state, JobState::kSucceeded);
  EXPECT_EQ(info.result_id, "model");
  EXPECT_EQ(info.fraction, 1);
  EXPECT_THAT(info.warnings, testing::ElementsAre("look here"));
}

TEST(JobStateMachineTest, FinalStatesStay) {
  for (const JobState state : {JobState::kSucceeded, JobState::kFailed, JobState::kCancelled}) {
    JobStateMachine job(Draft(state), 1);
    EXPECT_FALSE(job.Start(kNow) || job.Succeed("m", {}, kNow) ||
                 job.Fail(absl::InternalError("x"), kNow) || job.Cancelled(kNow) || job.Requeue());
    EXPECT_THAT(job.RequestCancel(kNow),
                HasStatus(absl::StatusCode::kFailedPrecondition, HasSubstr(JobStateName(state))));
    EXPECT_EQ(job.snapshot().info.state, state);
  }
}

TEST(JobStateMachineTest, EstimatesTheEndAndNeverGoesBack) {
  double now = 100;
  JobStateMachine job(Draft(), 0, [&] { return now; });
  job.Report({"early", .5, {}});
  EXPECT_EQ(job.snapshot().info.fraction, 0);
  ASSERT_TRUE(job.Start(kNow));
  now = 110;
  job.Report({"learn", .25, 7.5});
  JobInfo info = job.snapshot().info;
  EXPECT_EQ(info.stage, "learn");
  EXPECT_EQ(info.objective, 7.5);
  EXPECT_DOUBLE_EQ(info.eta_seconds.value(), 30);
  now = 122;  // whoever asks between two reports hears what is left by then
  EXPECT_DOUBLE_EQ(job.snapshot().info.eta_seconds.value(), 18);
  EXPECT_DOUBLE_EQ(job.WaitForChange(0, 0).info.eta_seconds.value(), 18);
  now = 1000;
  EXPECT_EQ(job.snapshot().info.eta_seconds.value(), 0);
  job.Report({"learn", .1, {}});
  EXPECT_EQ(job.snapshot().info.fraction, .25);
  EXPECT_DOUBLE_EQ(job.snapshot().info.eta_seconds.value(), 2700);  // of the largest fraction
  job.Report({"learn", 7, {}});
  EXPECT_EQ(job.snapshot().info.fraction, 1);
}

TEST(JobStateMachineTest, TheFirstMomentsAndTheEndHaveNoEstimate) {
  double now = 0;
  JobStateMachine job(Draft(), 0, [&] { return now; });
  ASSERT_TRUE(job.Start(kNow));
  now = .5;
  job.Report({"rig", .1, {}});
  EXPECT_FALSE(job.snapshot().info.eta_seconds.has_value());
  now = 60;
  job.Report({"rig", .01, {}});
  EXPECT_DOUBLE_EQ(job.snapshot().info.eta_seconds.value(), 540);
  ASSERT_TRUE(job.Succeed("model", {}, kNow));
  EXPECT_FALSE(job.snapshot().info.eta_seconds.has_value());
}

TEST(JobStateMachineTest, CancelsAtOnceWhileQueued) {
  JobStateMachine job(Draft(), 0);
  EXPECT_THAT(job.RequestCancel(kNow), IsOk());
  EXPECT_EQ(job.snapshot().info.state, JobState::kCancelled);
  EXPECT_FALSE(job.Start(kNow));
}

TEST(JobStateMachineTest, AsksARunningJobToStop) {
  JobStateMachine job(Draft(), 0);
  ASSERT_TRUE(job.Start(kNow));
  EXPECT_FALSE(job.cancel_requested());
  EXPECT_THAT(job.RequestCancel(kNow), IsOk());
  EXPECT_TRUE(job.cancel_requested());
  EXPECT_EQ(job.snapshot().info.state, JobState::kRunning);
  ASSERT_TRUE(job.Cancelled(kNow));
  EXPECT_THAT(job.snapshot().info.error, HasStatus(absl::StatusCode::kCancelled, testing::_));
}

TEST(JobStateMachineTest, KeepsTheTimesOfItsStartAndEnd) {
  JobStateMachine job(Draft(), 0);
  ASSERT_TRUE(job.Start(kNow));
  ASSERT_TRUE(job.Requeue());
  EXPECT_EQ(job.snapshot().info.started, std::nullopt);
  ASSERT_TRUE(job.Start(kNow + absl::Seconds(1)));
  EXPECT_EQ(job.snapshot().info.ended, std::nullopt);
  ASSERT_TRUE(job.Fail(absl::InternalError("x"), kNow + absl::Seconds(3)));
  EXPECT_FALSE(job.Fail(absl::InternalError("x"), kNow + absl::Seconds(9)));
  EXPECT_EQ(job.snapshot().info.started, kNow + absl::Seconds(1));
  EXPECT_EQ(job.snapshot().info.ended, kNow + absl::Seconds(3));
  JobStateMachine waiting(Draft(), 0);
  ASSERT_THAT(waiting.RequestCancel(kNow), IsOk());
  EXPECT_EQ(waiting.snapshot().info.started, std::nullopt);
  EXPECT_EQ(waiting.snapshot().info.ended, kNow);
}

TEST(JobStateMachineTest, RequeueForgetsTheAttempt) {
  JobStateMachine job(Draft(), 1);
  ASSERT_TRUE(job.Start(kNow));
  job.Report({"fit", .5, 1.0});
  ASSERT_TRUE(job.Requeue());
  const JobSnapshot snapshot = job.snapshot();
  EXPECT_EQ(snapshot.attempts, 1);
  EXPECT_EQ(snapshot.info.fraction, 0);
  EXPECT_EQ(snapshot.info.state, JobState::kQueued);
}

TEST(JobStateMachineTest, WaitersAndListenersHearEveryChange) {
  JobStateMachine job(Draft(), 0);
  std::atomic<int> calls = 0;
  const int token = job.AddListener([&] { ++calls; });
  std::thread worker([&] {
    job.Start(kNow);
    for (int i = 0; i < 100; ++i) job.Report({"learn", i / 100.0, {}});
    job.Succeed("m", {}, kNow);
  });
  JobSnapshot snapshot = job.snapshot();
  while (!IsFinal(snapshot.info.state)) {
    const JobSnapshot next = job.WaitForChange(snapshot.revision, 5);
    ASSERT_GT(next.revision, snapshot.revision);
    snapshot = next;
  }
  worker.join();
  EXPECT_EQ(calls, 102);
  job.RemoveListener(token);
  job.Wake();
  EXPECT_EQ(calls, 102);
}

TEST(JobStateMachineTest, WaitingEndsWithoutChange) {
  JobStateMachine job(Draft(), 0);
  EXPECT_EQ(job.WaitForChange(job.snapshot().revision, .01).info.state, JobState::kQueued);
}

// Whoever comes first decides; nobody sees two ends.
TEST(JobStateMachineTest, OneEndUnderConcurrency) {
  for (int round = 0; round < 200; ++round) {
    JobStateMachine job(Draft(), 0);
    ASSERT_TRUE(job.Start(kNow));
    std::atomic<int> ends = 0;
    std::thread a([&] { ends += job.Succeed("m", {}, kNow); });
    std::thread b([&] { ends += job.Fail(absl::InternalError("x"), kNow); });
    std::thread c([&] { ends += job.Cancelled(kNow); });
    a.join();
    b.join();
    c.join();
    EXPECT_EQ(ends, 1);
  }
}

}  // namespace
}  // namespace pleat
