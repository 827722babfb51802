#include "pleat/jobs/job_manager.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <map>
#include <mutex>
#include <set>
#include <thread>

#include "jobs/scripted_work.h"
#include "support/status_matchers.h"

namespace pleat {
namespace {

using std::chrono::steady_clock;
using ::testing::HasSubstr;

TEST(JobManagerTest, RunsJobsInOrderAndWritesThemDown) {
  Journal journal;
  std::vector<std::string> order;
  JobManager jobs(
      {},
      [&](const JobInfo& info, const Progress& progress) {
        order.push_back(info.name);
        return Succeeds()(info, progress);
      },
      &journal);
  std::vector<std::string> ids;
  for (const char* name : {"a", "b", "c"}) ids.push_back(jobs.Create(Named(name))->id);
  EXPECT_EQ(std::set<std::string>(ids.begin(), ids.end()).size(), 3u);
  EXPECT_EQ(journal.at(ids[2]).info.state, JobState::kQueued);
  jobs.Start();
  for (const std::string& id : ids) EXPECT_EQ(WaitForEnd(jobs, id).state, JobState::kSucceeded);
  EXPECT_EQ(order, (std::vector<std::string>{"a", "b", "c"}));
  EXPECT_EQ(jobs.Get(ids[1])->result_id, "model of b");
  jobs.Shutdown();
  EXPECT_EQ(journal.at(ids[0]).info.state, JobState::kSucceeded);
  EXPECT_THAT(journal.at(ids[0]).info.warnings, testing::ElementsAre("careful"));
  EXPECT_EQ(journal.at(ids[0]).attempts, 1);
}

TEST(JobManagerTest, TimesThatAreSeenAreThoseThatAreSaved) {
  Journal journal;
  std::atomic<int64_t> seconds = 1'800'000'000;  // later at every look
  JobManager jobs({.wall_clock = [&] { return absl::FromUnixSeconds(++seconds); }}, Succeeds(),
                  &journal);
  const JobInfo created = jobs.Create(Named("a")).value();
  EXPECT_EQ(created.created, absl::FromUnixSeconds(1'800'000'001));
  EXPECT_TRUE(!created.started && !created.ended);
  jobs.Start();
  const JobInfo ended = WaitForEnd(jobs, created.id);
  EXPECT_EQ(ended.created, created.created);
  ASSERT_TRUE(ended.started && ended.ended);
  EXPECT_LT(*ended.created, *ended.started);
  EXPECT_LT(*ended.started, *ended.ended);
  const JobInfo saved = journal.at(created.id).info;
  EXPECT_EQ(saved.started, ended.started);
  EXPECT_EQ(saved.ended, ended.ended);
}

TEST(JobManagerTest, OneClientCannotHaveAllPlacesOfTheQueue) {
  Journal journal;
  JobManager jobs({.max_queued = 4, .max_queued_per_client = 2}, Succeeds(), &journal);
  const auto create = [&](const std::string& client) {
    JobInfo draft = Named("job");
    draft.client = client;
    return jobs.Create(draft).status();
  };
  EXPECT_THAT(create("ada"), IsOk());
  EXPECT_THAT(create("ada"), IsOk());
  EXPECT_THAT(create("ada"),
              HasStatus(absl::StatusCode::kResourceExhausted, HasSubstr("this client has 2")));
  EXPECT_THAT(create("zoe"), IsOk());
  EXPECT_THAT(create("rea"), IsOk());
  EXPECT_THAT(create("otto"),
              HasStatus(absl::StatusCode::kResourceExhausted, HasSubstr("4 jobs are waiting")));
}

TEST(JobManagerTest, TellsHowLongAJobWasInEachStage) {
  Journal journal;
  std::atomic<double> now = 0;
  std::vector<std::pair<std::string, double>> stages;
  JobManager jobs(
      {.on_stage = [&](const std::string& stage,
                       double seconds) { stages.emplace_back(stage, seconds); },
       .clock = [&] { return now.load(); }},
      [&](const JobInfo&, const Progress& progress) -> absl::StatusOr<JobOutcome> {
        progress.Stage("read", 0, .5).Report(.1).IgnoreError();
        now = now + 2;
        progress.Stage("read", 0, .5).Report(.9).IgnoreError();
        now = now + 1;
        progress.Stage("learn", .5, 1).Report(.5).IgnoreError();
        now = now + 5;
        return JobOutcome{"model", {}};
      },
      &journal);
  PLEAT_ASSERT_OK_AND_ASSIGN(const JobInfo job, jobs.Create(Named("job")));
  jobs.Start();
  EXPECT_EQ(WaitForEnd(jobs, job.id).state, JobState::kSucceeded);
  jobs.Shutdown();
  EXPECT_THAT(stages, testing::ElementsAre(std::pair("read", 3.), std::pair("learn", 5.)));
}

TEST(JobManagerTest, RunsAsManyAsItHasWorkers) {
  Journal journal;
  Running running;
  // The first two end only when both run, so one worker would never be done; a third worker would
  // show in most().
  JobManager jobs(
      {.num_workers = 2},
      [&](const JobInfo& info, const Progress&) -> absl::StatusOr<JobOutcome> {
        running.Enter();
        const bool both = running.WaitForEntered(2);
        running.Leave();
        if (!both) return absl::DeadlineExceededError("alone");
        return JobOutcome{info.name, {}};
      },
      &journal);
  std::vector<std::string> ids;
  for (int i = 0; i < 4; ++i) ids.push_back(jobs.Create(Named("x"))->id);
  jobs.Start();
  for (const std::string& id : ids) EXPECT_EQ(WaitForEnd(jobs, id).state, JobState::kSucceeded);
  EXPECT_EQ(running.most(), 2);
}

TEST(JobManagerTest, JobsBeyondTheWorkersStayQueued) {
  Journal journal;
  Running running;
  JobManager jobs({.num_workers = 2}, NeverEnds(&running), &journal);
  std::vector<std::string> ids;
  for (int i = 0; i < 3; ++i) ids.push_back(jobs.Create(Named("x"))->id);
  jobs.Start();
  ASSERT_TRUE(running.WaitForEntered(2));
  EXPECT_EQ(jobs.Get(ids[2])->state, JobState::kQueued);
  EXPECT_THAT(jobs.Cancel(ids[0]), IsOk());
  ASSERT_TRUE(running.WaitForEntered(3));  // it takes the place that became free
  EXPECT_EQ(jobs.Get(ids[2])->state, JobState::kRunning);
}

TEST(JobManagerTest, CancellationActsWithinASecond) {
  Journal journal;
  Running running;
  JobManager jobs({}, NeverEnds(&running), &journal);
  jobs.Start();
  const std::string first = jobs.Create(Named("runs"))->id;
  const std::string second = jobs.Create(Named("waits"))->id;
  ASSERT_TRUE(running.WaitForEntered(1));
  EXPECT_THAT(jobs.Cancel(second), IsOk());
  EXPECT_EQ(jobs.Get(second)->state, JobState::kCancelled);
  EXPECT_EQ(journal.at(second).info.state, JobState::kCancelled);
  const auto start = steady_clock::now();
  EXPECT_THAT(jobs.Cancel(first), IsOk());
  EXPECT_EQ(WaitForEnd(jobs, first).state, JobState::kCancelled);
  EXPECT_LT(steady_clock::now() - start, std::chrono::seconds(1));
  EXPECT_THAT(jobs.Cancel(first),
              HasStatus(absl::StatusCode::kFailedPrecondition, HasSubstr("cancelled")));
  EXPECT_THAT(jobs.Cancel("job-x"), HasStatus(absl::StatusCode::kNotFound, testing::_));
}

TEST(JobManagerTest, FailuresAndExceptionsEndOneJobOnly) {
  Journal journal;
  JobManager jobs(
      {},
      [&](const JobInfo& info, const Progress& progress) -> absl::StatusOr<JobOutcome> {
        if (info.name == "throws") throw std::runtime_error("boom");
        if (info.name == "memory") throw std::bad_alloc();
        if (info.name == "fails") return absl::FailedPreconditionError("no rig fits");
        return Succeeds()(info, progress);
      },
      &journal);
  jobs.Start();
  const std::string throws = jobs.Create(Named("throws"))->id;
  const std::string memory = jobs.Create(Named("memory"))->id;
  const std::string fails = jobs.Create(Named("fails"))->id;
  const std::string good = jobs.Create(Named("good"))->id;
  EXPECT_EQ(WaitForEnd(jobs, good).state, JobState::kSucceeded);
  EXPECT_THAT(jobs.Get(throws)->error,
              HasStatus(absl::StatusCode::kInternal, testing::Not(HasSubstr("boom"))));
  EXPECT_THAT(jobs.Get(memory)->error,
              HasStatus(absl::StatusCode::kResourceExhausted, HasSubstr("memory")));
  EXPECT_THAT(jobs.Get(fails)->error,
              HasStatus(absl::StatusCode::kFailedPrecondition, HasSubstr("rig")));
}

// Saving may take as long as a test wants.
class SlowJournal final : public Journal {
 public:
  absl::Status Save(const JobInfo& info, int attempts) override {
    {
      std::unique_lock lock(mutex_);
      waits_ = blocked_;
      changed_.notify_all();
      changed_.wait(lock, [&] { return !blocked_; });
    }
    return Journal::Save(info, attempts);
  }
  void Block() {
    std::lock_guard lock(mutex_);
    blocked_ = true;
    waits_ = false;
  }
  void WaitForASave() {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [&] { return waits_; });
  }
  void Unblock() {
    std::lock_guard lock(mutex_);
    blocked_ = false;
    changed_.notify_all();
  }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  bool blocked_ = false, waits_ = false;  // guarded by mutex_
};

TEST(JobManagerTest, WhoAsksDoesNotWaitForAJobThatIsSaved) {
  SlowJournal journal;
  JobManager jobs({}, Succeeds(), &journal);
  const auto while_one_is_saved = [&](auto&& change, auto&& ask) {
    journal.Block();
    std::thread changer(change);
    journal.WaitForASave();
    ask();
    journal.Unblock();
    changer.join();
  };
  PLEAT_ASSERT_OK_AND_ASSIGN(const JobInfo first, jobs.Create({}));  // the workers do not run
  while_one_is_saved([&] { EXPECT_THAT(jobs.Create({}), IsOk()); },
                     [&] {
                       EXPECT_THAT(jobs.Get(first.id), IsOk());
                       // Not yet saved, so not yet there.
                       EXPECT_EQ(jobs.ListUnfinished().size(), 1u);
                     });
  EXPECT_EQ(jobs.ListUnfinished().size(), 2u);
  while_one_is_saved([&] { EXPECT_THAT(jobs.Cancel(first.id), IsOk()); },
                     [&] { EXPECT_EQ(jobs.ListUnfinished().size(), 2u); });
  EXPECT_EQ(jobs.ListUnfinished().size(), 1u);
  EXPECT_EQ(jobs.Get(first.id)->state, JobState::kCancelled);
}

// Memory grew with every job that had ever ended.
TEST(JobManagerTest, WhatHasEndedIsInTheJournalAlone) {
  Journal journal;
  JobManager jobs({}, Succeeds(), &journal);
  std::vector<std::string> ids;
  for (int i = 0; i < 20; ++i) ids.push_back(jobs.Create(Named("x"))->id);
  ASSERT_THAT(jobs.Cancel(ids.back()), IsOk());
  const auto watched = jobs.Find(ids[0]).value();
  const std::weak_ptr<JobStateMachine> unwatched = jobs.Find(ids[1]).value();
  jobs.Start();
  for (const std::string& id : ids) EXPECT_TRUE(IsFinal(WaitForEnd(jobs, id).state));
  jobs.Shutdown();
  EXPECT_TRUE(jobs.ListUnfinished().empty());
  EXPECT_TRUE(unwatched.expired());
  EXPECT_EQ(watched->snapshot().info.state, JobState::kSucceeded);  // whoever holds it saw its end
  const int num_reads = journal.num_reads();
  EXPECT_EQ(jobs.Get(ids[3])->result_id, "model of x");
  EXPECT_EQ(journal.num_reads(), num_reads + 1);
  EXPECT_THAT(jobs.Cancel(ids[3]), HasStatus(absl::StatusCode::kFailedPrecondition, HasSubstr("")));
}

// Of two calls that cancel one job, the second made it final before that was saved.
TEST(JobManagerTest, TwoCallsCancelAJobOnce) {
  SlowJournal journal;
  JobManager jobs({}, Succeeds(), &journal);
  const std::string id = jobs.Create(Named("x"))->id;
  journal.Block();
  std::thread first([&] { EXPECT_THAT(jobs.Cancel(id), IsOk()); });
  journal.WaitForASave();
  std::thread second([&] {
    EXPECT_THAT(jobs.Cancel(id),
                HasStatus(absl::StatusCode::kFailedPrecondition, HasSubstr("cancelled")));
  });
  EXPECT_EQ(jobs.Get(id)->state, JobState::kQueued);
  journal.Unblock();
  first.join();
  second.join();
  EXPECT_EQ(journal.at(id).info.state, JobState::kCancelled);
}

TEST(JobManagerTest, RefusesWhenFullOrNotSaved) {
  Journal journal;
  JobManager jobs({.max_queued = 2}, Succeeds(), &journal);
  ASSERT_TRUE(jobs.Create(Named("a")).ok());
  journal.Fail(true);
  EXPECT_THAT(jobs.Create(Named("b")),
              HasStatus(absl::StatusCode::kResourceExhausted, HasSubstr("disk")));
  journal.Fail(false);
  ASSERT_TRUE(jobs.Create(Named("b")).ok());
  EXPECT_THAT(jobs.Create(Named("c")),
              HasStatus(absl::StatusCode::kResourceExhausted, HasSubstr("limit is 2")));
  EXPECT_EQ(jobs.ListUnfinished().size(), 2u);
}

}  // namespace
}  // namespace pleat
