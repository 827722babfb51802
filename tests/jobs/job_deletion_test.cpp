// Jobs that are forgotten.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <string>
#include <thread>
#include <vector>

#include "jobs/scripted_work.h"
#include "support/status_matchers.h"

namespace pleat {
namespace {

using ::testing::HasSubstr;

TEST(JobDeletionTest, OnlyAJobThatHasEndedIsForgotten) {
  Journal journal;
  Running running;
  JobManager jobs({}, NeverEnds(&running), &journal);
  const std::string runs = jobs.Create(Named("a"))->id, waits = jobs.Create(Named("b"))->id;
  jobs.Start();
  ASSERT_TRUE(running.WaitForEntered(1));
  EXPECT_THAT(jobs.Delete(runs),
              HasStatus(absl::StatusCode::kFailedPrecondition, HasSubstr("is running")));
  EXPECT_THAT(jobs.Delete(waits),
              HasStatus(absl::StatusCode::kFailedPrecondition, HasSubstr("is queued")));
  EXPECT_THAT(jobs.Delete("job-none"), HasStatus(absl::StatusCode::kNotFound, testing::_));
  ASSERT_THAT(jobs.Cancel(waits), IsOk());
  ASSERT_THAT(jobs.Delete(waits), IsOk());
  EXPECT_THAT(jobs.Get(waits), HasStatus(absl::StatusCode::kNotFound, testing::_));
  EXPECT_EQ(jobs.ListUnfinished().size(), 1u);
  EXPECT_EQ(journal.size(), 1u);
  ASSERT_THAT(jobs.Cancel(runs), IsOk());
  EXPECT_EQ(WaitForEnd(jobs, runs).state, JobState::kCancelled);
  EXPECT_THAT(jobs.Delete(runs), IsOk());
  EXPECT_EQ(journal.size(), 0u);
}

TEST(JobDeletionTest, TheOthersKeepTheirOrder) {
  Journal journal;
  JobManager jobs({}, Succeeds(), &journal);
  std::vector<std::string> ids;
  for (const char* name : {"a", "b", "c"}) ids.push_back(jobs.Create(Named(name))->id);
  ASSERT_THAT(jobs.Cancel(ids[1]), IsOk());
  ASSERT_THAT(jobs.Delete(ids[1]), IsOk());
  ids.push_back(jobs.Create(Named("d"))->id);
  EXPECT_THAT(journal.names(), testing::ElementsAre("a", "c", "d"));
}

TEST(JobDeletionTest, AJobThatCannotBeErasedStays) {
  Journal journal;
  JobManager jobs({}, Succeeds(), &journal);
  const std::string id = jobs.Create(Named("a"))->id;
  ASSERT_THAT(jobs.Cancel(id), IsOk());
  journal.Fail(true);
  EXPECT_THAT(jobs.Delete(id), HasStatus(absl::StatusCode::kResourceExhausted, "disk full"));
  EXPECT_EQ(jobs.Get(id)->state, JobState::kCancelled);
  journal.Fail(false);
  EXPECT_THAT(jobs.Delete(id), IsOk());
}

TEST(JobDeletionTest, ItsRequestIdIsFreeAgain) {
  Journal journal;
  JobManager jobs({}, Succeeds(), &journal);
  JobInfo draft = Named("a");
  draft.request_id = "once";
  const std::string id = jobs.Create(draft)->id;
  EXPECT_EQ(jobs.Create(draft)->id, id);
  ASSERT_THAT(jobs.Cancel(id), IsOk());
  ASSERT_THAT(jobs.Delete(id), IsOk());
  EXPECT_NE(jobs.Create(draft)->id, id);
}

// A job that is cancelled in the moment in which a worker takes it is final before the worker saves
// it; that save must not bring back what was erased meanwhile.
TEST(JobDeletionTest, NoSaveBringsADeletedJobBack) {
  for (int round = 0; round < 200; ++round) {
    Journal journal;
    Running running;
    JobManager jobs({.num_workers = 2}, NeverEnds(&running), &journal);
    const std::string id = jobs.Create(Named("a"))->id;
    std::thread starter([&] { jobs.Start(); });
    jobs.Cancel(id).IgnoreError();
    starter.join();
    EXPECT_EQ(WaitForEnd(jobs, id).state, JobState::kCancelled);
    EXPECT_THAT(jobs.Delete(id), IsOk());
    jobs.Shutdown();
    EXPECT_EQ(journal.size(), 0u);
  }
}

}  // namespace
}  // namespace pleat
