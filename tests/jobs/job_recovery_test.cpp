// What restarts, shutdowns and a store that cannot be written do to jobs.
#include <gtest/gtest.h>

#include <chrono>
#include <string>

#include "jobs/scripted_work.h"
#include "support/status_matchers.h"

namespace pleat {
namespace {

using std::chrono::steady_clock;
using ::testing::HasSubstr;

TEST(JobRecoveryTest, ShutdownQueuesWhatWasRunning) {
  Journal journal;
  Running running;
  std::string id;
  {
    JobManager jobs({}, NeverEnds(&running), &journal);
    jobs.Start();
    id = jobs.Create(Named("x"))->id;
    ASSERT_TRUE(running.WaitForEntered(1));
    const auto start = steady_clock::now();
    jobs.Shutdown();
    EXPECT_LT(steady_clock::now() - start, std::chrono::seconds(1));
    EXPECT_THAT(jobs.Create(Named("y")),
                HasStatus(absl::StatusCode::kUnavailable, HasSubstr("shutting down")));
  }
  EXPECT_EQ(journal.at(id).info.state, JobState::kQueued);
  EXPECT_EQ(journal.at(id).attempts, 0);

  JobManager jobs({}, Succeeds(), &journal);
  jobs.Restore({journal.at(id)});
  jobs.Start();
  EXPECT_EQ(WaitForEnd(jobs, id).state, JobState::kSucceeded);
}

TEST(JobRecoveryTest, ACrashedJobRunsAgainThreeTimes) {
  Journal journal;
  JobInfo crashed = Named("x");
  crashed.id = "job-crashed";
  crashed.state = JobState::kRunning;
  crashed.fraction = .7;
  JobInfo hopeless = crashed;
  hopeless.id = "job-hopeless";
  JobInfo done = crashed;
  done.id = "job-done";
  done.state = JobState::kSucceeded;
  ASSERT_THAT(journal.Save(done, 1), IsOk());
  JobManager hopeless_jobs({}, Succeeds(), &journal);
  hopeless_jobs.Restore({{hopeless, 3}});
  EXPECT_EQ(hopeless_jobs.Get("job-done")->state, JobState::kSucceeded);
  EXPECT_EQ(hopeless_jobs.Get("job-hopeless")->state, JobState::kFailed);
  EXPECT_THAT(hopeless_jobs.Get("job-hopeless")->error,
              HasStatus(absl::StatusCode::kAborted, HasSubstr("3 times")));
  EXPECT_EQ(journal.at("job-hopeless").info.state, JobState::kFailed);
  JobManager jobs({}, Succeeds(), &journal);
  jobs.Restore({{crashed, 2}});
  EXPECT_EQ(jobs.Get("job-crashed")->state, JobState::kQueued);
  EXPECT_EQ(jobs.Get("job-crashed")->fraction, 0);
  jobs.Start();
  EXPECT_EQ(WaitForEnd(jobs, "job-crashed").state, JobState::kSucceeded);
  EXPECT_EQ(jobs.Find("job-crashed").value()->snapshot().attempts, 3);
}

JobInfo WasRunning(const std::string& id) {
  JobInfo info;
  info.id = id;
  info.state = JobState::kRunning;
  return info;
}

TEST(JobRecoveryTest, AHopelessJobThatCannotBeSavedIsSeenAndCanBeDeleted) {
  Journal journal;
  JobInfo hopeless = Named("x");
  hopeless.id = "job-hopeless";
  hopeless.state = JobState::kRunning;
  ASSERT_THAT(journal.Save(hopeless, 3), IsOk());
  journal.Fail(true);
  JobManager jobs({}, Succeeds(), &journal);
  jobs.Restore({{hopeless, 3}});
  EXPECT_EQ(jobs.Get("job-hopeless")->state, JobState::kFailed);
  EXPECT_TRUE(jobs.ListUnfinished().empty());
  journal.Fail(false);
  EXPECT_THAT(jobs.Delete("job-hopeless"), IsOk());
  EXPECT_EQ(journal.size(), 0u);
}

// Whoever ran beside the job that took the server down was blamed with it.
TEST(JobRecoveryTest, JobsThatRanBesideOthersAreNotBlamed) {
  Journal journal;
  JobManager jobs({}, Succeeds(), &journal);
  jobs.Restore({{WasRunning("a"), 3}, {WasRunning("b"), 1}});
  EXPECT_EQ(journal.at("a").info.state, JobState::kQueued);
  EXPECT_EQ(journal.at("a").attempts, 2);
  EXPECT_EQ(journal.at("b").attempts, 0);
}

TEST(JobRecoveryTest, SuspectsRunAlone) {
  Journal journal;
  Running running;
  JobManager jobs({.num_workers = 3}, NeverEnds(&running), &journal);
  jobs.Restore({{WasRunning("a"), 1}, {WasRunning("b"), 1}});
  for (int i = 0; i < 2; ++i) ASSERT_TRUE(jobs.Create(Named("new")).ok());
  jobs.Start();
  for (const char* suspect : {"a", "b"}) {
    ASSERT_TRUE(running.WaitForEntered(suspect[0] - 'a' + 1));
    int num_running = 0;
    for (const JobInfo& info : jobs.ListUnfinished())
      num_running += info.state == JobState::kRunning;
    EXPECT_EQ(num_running, 1);
    EXPECT_EQ(jobs.Get(suspect)->state, JobState::kRunning);
    EXPECT_THAT(jobs.Cancel(suspect), IsOk());
  }
  ASSERT_TRUE(running.WaitForEntered(4));  // the others run together
  EXPECT_EQ(running.most(), 2);
}

// The job when it has its first warning.
JobInfo WaitForWarning(JobManager& jobs, const std::string& id) {
  const auto job = jobs.Find(id).value();
  JobSnapshot snapshot = job->snapshot();
  while (snapshot.info.warnings.empty()) snapshot = job->WaitForChange(snapshot.revision, .2);
  return snapshot.info;
}

// A failed job became a successful one after a restart, when its row could not be written.
TEST(JobRecoveryTest, NobodySeesAnEndThatIsNotSaved) {
  Journal journal;
  Running running;
  JobManager jobs(
      {.save_retry_seconds = 1e-3},
      [&](const JobInfo&, const Progress&) -> absl::StatusOr<JobOutcome> {
        journal.Fail(true);
        return absl::FailedPreconditionError("no rig fits");
      },
      &journal);
  const std::string id = jobs.Create(Named("x"))->id;
  jobs.Start();
  const JobInfo warned = WaitForWarning(jobs, id);
  EXPECT_THAT(warned.warnings[0], HasSubstr("disk full"));
  EXPECT_EQ(warned.state, JobState::kRunning);
  EXPECT_EQ(journal.at(id).info.state, JobState::kRunning);
  journal.Fail(false);
  EXPECT_EQ(WaitForEnd(jobs, id).state, JobState::kFailed);
  EXPECT_EQ(journal.at(id).info.state, JobState::kFailed);
}

TEST(JobRecoveryTest, AnEndThatCannotBeSavedDoesNotHoldUpAShutdown) {
  Journal journal;
  JobManager jobs(
      {.save_retry_seconds = 1e6},
      [&](const JobInfo&, const Progress&) -> absl::StatusOr<JobOutcome> {
        journal.Fail(true);
        return JobOutcome{"model", {}};
      },
      &journal);
  const std::string id = jobs.Create(Named("x"))->id;
  jobs.Start();
  WaitForWarning(jobs, id);
  jobs.Shutdown();
  EXPECT_FALSE(IsFinal(jobs.Get(id)->state));
  EXPECT_EQ(journal.at(id).info.state, JobState::kRunning);  // the next process runs it again
}

// A lost answer made two jobs.
TEST(JobRecoveryTest, ARepeatedRequestMakesNoSecondJob) {
  Journal journal;
  JobInfo draft = Named("x");
  draft.sequence_ids = {"s"};
  draft.request_id = "once";
  std::string id;
  {
    JobManager jobs({}, Succeeds(), &journal);
    id = jobs.Create(draft)->id;
    EXPECT_EQ(jobs.Create(draft)->id, id);
    JobInfo other = draft;
    other.sequence_ids = {"t"};
    EXPECT_THAT(jobs.Create(other), HasStatus(absl::StatusCode::kAlreadyExists, HasSubstr(id)));
    other.request_id = "another";
    EXPECT_NE(jobs.Create(other)->id, id);
    EXPECT_EQ(jobs.ListUnfinished().size(), 2u);
  }
  JobManager jobs({.max_queued = 1}, Succeeds(), &journal);
  jobs.Restore({journal.at(id)});
  EXPECT_EQ(jobs.Create(draft)->id, id);  // also after a restart, and with a full queue
  jobs.Start();
  EXPECT_EQ(WaitForEnd(jobs, id).state, JobState::kSucceeded);
  EXPECT_EQ(jobs.Create(draft)->state, JobState::kSucceeded);
}

TEST(JobRecoveryTest, ACancellationThatIsNotSavedIsRefused) {
  Journal journal;
  JobManager jobs({}, Succeeds(), &journal);
  const std::string id = jobs.Create(Named("x"))->id;
  journal.Fail(true);
  EXPECT_THAT(jobs.Cancel(id), HasStatus(absl::StatusCode::kResourceExhausted, HasSubstr("disk")));
  EXPECT_EQ(jobs.Get(id)->state, JobState::kQueued);
  journal.Fail(false);
  jobs.Start();
  EXPECT_EQ(WaitForEnd(jobs, id).state, JobState::kSucceeded);
}

}  // namespace
}  // namespace pleat
