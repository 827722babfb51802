#include "pleat/service/job_service.h"

#include <gtest/gtest.h>

#include <atomic>
#include <set>
#include <thread>

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

TEST(JobState, EveryStateHasANameOfItsOwn) {
  std::set<std::string> names;
  for (const JobState state : {JobState::kQueued, JobState::kRunning, JobState::kSucceeded,
                               JobState::kFailed, JobState::kCancelled}) {
    names.insert(JobStateName(state));
  }
  EXPECT_EQ(names,
            (std::set<std::string>{"cancelled", "failed", "queued", "running", "succeeded"}));
  EXPECT_STREQ(JobStateName(static_cast<JobState>(99)), "unknown");
  EXPECT_FALSE(IsFinal(static_cast<JobState>(99)));
}

// A job whose state the test sets, from any thread.
struct HeldJob {
  std::atomic<JobState> state = JobState::kRunning;
  std::atomic<uint64_t> revision = 1;
  std::atomic<bool> ended = false;  // the subscription, without a final state
};

class HeldSubscription final : public JobSubscription {
 public:
  explicit HeldSubscription(const HeldJob& job) : job_(job) {}
  JobUpdate current() const override { return {Job(job_.state), job_.revision}; }
  absl::Status status() const override {
    return job_.ended ? absl::UnavailableError("gone") : absl::OkStatus();
  }

 private:
  const HeldJob& job_;
};

class HeldJobTest : public testing::Test {
 protected:
  HeldJobTest() {
    EXPECT_CALL(jobs_, Subscribe)
        .WillOnce([this](const std::string&, std::function<void()> listener) {
          listener_ = std::move(listener);
          return std::make_unique<HeldSubscription>(held_);
        });
  }

  testing::StrictMock<MockJobService> jobs_;
  std::function<void()> listener_;
  HeldJob held_;
};

// Without news the observer is asked again, so that one who wants to stop is heard.
TEST_F(HeldJobTest, AnObserverWithoutNewsCanStop) {
  int num_looks = 0;
  EXPECT_THAT(WatchJob(jobs_, "job-1", [&](const JobInfo&) { return ++num_looks < 2; }), IsOk());
  EXPECT_EQ(num_looks, 2);
}

TEST_F(HeldJobTest, NewsFromAnotherThreadAreSeen) {
  std::thread worker;
  std::vector<JobState> seen;
  EXPECT_THAT(WatchJob(jobs_, "job-1",
                       [&](const JobInfo& job) {
                         seen.push_back(job.state);
                         if (seen.size() > 1) return true;
                         worker = std::thread([&] {
                           held_.state = JobState::kSucceeded;
                           ++held_.revision;
                           listener_();
                         });
                         return true;
                       }),
              IsOk());
  worker.join();
  EXPECT_EQ(seen.front(), JobState::kRunning);
  EXPECT_EQ(seen.back(), JobState::kSucceeded);
}

TEST_F(HeldJobTest, ALastChangeIsShownThoughTheSubscriptionHasEnded) {
  std::vector<JobState> seen;
  EXPECT_THAT(WatchJob(jobs_, "job-1",
                       [&](const JobInfo& job) {
                         seen.push_back(job.state);
                         held_.state = JobState::kFailed;
                         ++held_.revision;
                         held_.ended = true;
                         return true;
                       }),
              IsOk());
  EXPECT_THAT(seen, ElementsAre(JobState::kRunning, JobState::kFailed));
}

TEST_F(HeldJobTest, AnEndWithoutNewsIsItsError) {
  EXPECT_THAT(WatchJob(jobs_, "job-1",
                       [&](const JobInfo&) {
                         held_.ended = true;
                         listener_();
                         return true;
                       }),
              HasStatus(absl::StatusCode::kUnavailable, "gone"));
}

// A service may ring for a moment after the subscription is gone.
TEST_F(HeldJobTest, AListenerThatRingsTooLateHarmsNothing) {
  EXPECT_THAT(WatchJob(jobs_, "job-1", [](const JobInfo&) { return false; }), IsOk());
  listener_();
}

}  // namespace
}  // namespace pleat
