#include "pleat/jobs/job_manager.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <map>
#include <mutex>
#include <set>
#include <thread>

#include "support/status_matchers.h"

namespace pleat {
namespace {

using std::chrono::milliseconds;
using std::chrono::steady_clock;
using ::testing::HasSubstr;

// A store that remembers the newest save of every job.
class Journal {
 public:
  SaveJob save() {
    return [this](const JobInfo& info, int attempts) {
      std::lock_guard lock(mutex_);
      if (fail_) return absl::ResourceExhaustedError("disk full");
      saved_[info.id] = {info, attempts};
      return absl::OkStatus();
    };
  }
  StoredJob at(const std::string& id) {
    std::lock_guard lock(mutex_);
    return saved_.at(id);
  }
  void Fail(bool fail) {
    std::lock_guard lock(mutex_);
    fail_ = fail;
  }
  size_t size() {
    std::lock_guard lock(mutex_);
    return saved_.size();
  }

 private:
  std::mutex mutex_;
  std::map<std::string, StoredJob> saved_;
  bool fail_ = false;
};

JobInfo WaitForEnd(JobManager& jobs, const std::string& id) {
  const auto job = jobs.Find(id).value();
  JobSnapshot snapshot = job->snapshot();
  const auto deadline = steady_clock::now() + std::chrono::seconds(10);
  while (!IsFinal(snapshot.info.state) && steady_clock::now() < deadline) {
    snapshot = job->WaitForChange(snapshot.revision, .2);
  }
  return snapshot.info;
}

RunJob Succeeds() {
  return [](const JobInfo& info, const Progress& progress) -> absl::StatusOr<JobOutcome> {
    if (absl::Status status = progress.Report(.5); !status.ok()) return status;
    return JobOutcome{"model of " + info.name, {"careful"}};
  };
}

// How many jobs run now and have run at most, and a wait for them.
class Running {
 public:
  void Enter() {
    std::lock_guard lock(mutex_);
    ++now_;
    ++entered_;
    most_ = std::max(most_, now_);
    changed_.notify_all();
  }
  void Leave() {
    std::lock_guard lock(mutex_);
    --now_;
  }
  // Until `count` jobs have begun; false when that takes so long that they never will.
  bool WaitForEntered(int count) {
    std::unique_lock lock(mutex_);
    return changed_.wait_for(lock, std::chrono::seconds(30), [&] { return entered_ >= count; });
  }
  // A moment in which nothing is decided, between two looks at a flag that cannot notify.
  void Pause() {
    std::unique_lock lock(mutex_);
    changed_.wait_for(lock, milliseconds(1));
  }
  int most() {
    std::lock_guard lock(mutex_);
    return most_;
  }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  int now_ = 0, entered_ = 0, most_ = 0;
};

// Runs until it is cancelled.
RunJob NeverEnds(Running* running) {
  return [running](const JobInfo&, const Progress& progress) -> absl::StatusOr<JobOutcome> {
    running->Enter();
    while (!progress.cancelled()) running->Pause();
    running->Leave();
    return absl::CancelledError("stopped");
  };
}

JobInfo Named(const std::string& name) {
  JobInfo info;
  info.name = name;
  return info;
}

TEST(JobManagerTest, RunsJobsInOrderAndWritesThemDown) {
  Journal journal;
  std::vector<std::string> order;
  JobManager jobs(
      {},
      [&](const JobInfo& info, const Progress& progress) {
        order.push_back(info.name);
        return Succeeds()(info, progress);
      },
      journal.save());
  std::vector<std::string> ids;
  for (const char* name : {"a", "b", "c"}) ids.push_back(jobs.Create(Named(name))->id);
  EXPECT_EQ(std::set<std::string>(ids.begin(), ids.end()).size(), 3u);
  EXPECT_EQ(journal.at(ids[2]).info.state, JobState::kQueued);
  jobs.Start();
  for (const std::string& id : ids) EXPECT_EQ(WaitForEnd(jobs, id).state, JobState::kSucceeded);
  EXPECT_EQ(order, (std::vector<std::string>{"a", "b", "c"}));
  EXPECT_EQ(jobs.List()[1].result_id, "model of b");
  jobs.Shutdown();
  EXPECT_EQ(journal.at(ids[0]).info.state, JobState::kSucceeded);
  EXPECT_THAT(journal.at(ids[0]).info.warnings, testing::ElementsAre("careful"));
  EXPECT_EQ(journal.at(ids[0]).attempts, 1);
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
      journal.save());
  std::vector<std::string> ids;
  for (int i = 0; i < 4; ++i) ids.push_back(jobs.Create(Named("x"))->id);
  jobs.Start();
  for (const std::string& id : ids) EXPECT_EQ(WaitForEnd(jobs, id).state, JobState::kSucceeded);
  EXPECT_EQ(running.most(), 2);
}

TEST(JobManagerTest, JobsBeyondTheWorkersStayQueued) {
  Journal journal;
  Running running;
  JobManager jobs({.num_workers = 2}, NeverEnds(&running), journal.save());
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
  JobManager jobs({}, NeverEnds(&running), journal.save());
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
      journal.save());
  jobs.Start();
  const std::string throws = jobs.Create(Named("throws"))->id;
  const std::string memory = jobs.Create(Named("memory"))->id;
  const std::string fails = jobs.Create(Named("fails"))->id;
  const std::string good = jobs.Create(Named("good"))->id;
  EXPECT_EQ(WaitForEnd(jobs, good).state, JobState::kSucceeded);
  EXPECT_THAT(jobs.Get(throws)->error, HasStatus(absl::StatusCode::kInternal, HasSubstr("boom")));
  EXPECT_THAT(jobs.Get(memory)->error,
              HasStatus(absl::StatusCode::kResourceExhausted, HasSubstr("memory")));
  EXPECT_THAT(jobs.Get(fails)->error,
              HasStatus(absl::StatusCode::kFailedPrecondition, HasSubstr("rig")));
}

TEST(JobManagerTest, ShutdownQueuesWhatWasRunning) {
  Journal journal;
  Running running;
  std::string id;
  {
    JobManager jobs({}, NeverEnds(&running), journal.save());
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

  JobManager jobs({}, Succeeds(), journal.save());
  jobs.Restore({journal.at(id)});
  jobs.Start();
  EXPECT_EQ(WaitForEnd(jobs, id).state, JobState::kSucceeded);
}

TEST(JobManagerTest, ACrashedJobRunsAgainThreeTimes) {
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
  JobManager jobs({}, Succeeds(), journal.save());
  jobs.Restore({{crashed, 2}, {hopeless, 3}, {done, 1}});
  EXPECT_EQ(jobs.Get("job-crashed")->state, JobState::kQueued);
  EXPECT_EQ(jobs.Get("job-crashed")->fraction, 0);
  EXPECT_EQ(jobs.Get("job-done")->state, JobState::kSucceeded);
  EXPECT_EQ(jobs.Get("job-hopeless")->state, JobState::kFailed);
  EXPECT_THAT(jobs.Get("job-hopeless")->error,
              HasStatus(absl::StatusCode::kAborted, HasSubstr("3 times")));
  EXPECT_EQ(journal.at("job-hopeless").info.state, JobState::kFailed);
  jobs.Start();
  EXPECT_EQ(WaitForEnd(jobs, "job-crashed").state, JobState::kSucceeded);
  EXPECT_EQ(jobs.Find("job-crashed").value()->snapshot().attempts, 3);
}

TEST(JobManagerTest, WhoAsksDoesNotWaitForAJobThatIsSaved) {
  std::mutex mutex;
  std::condition_variable changed;
  bool blocked = false, waits = false;  // guarded by mutex
  JobManager jobs({}, Succeeds(), [&](const JobInfo&, int) {
    std::unique_lock lock(mutex);
    waits = blocked;
    changed.notify_all();
    changed.wait(lock, [&] { return !blocked; });
    return absl::OkStatus();
  });
  const auto while_one_is_saved = [&](auto&& change, auto&& ask) {
    {
      std::lock_guard lock(mutex);
      blocked = true;
      waits = false;
    }
    std::thread changer(change);
    {
      std::unique_lock lock(mutex);
      changed.wait(lock, [&] { return waits; });
    }
    ask();
    {
      std::lock_guard lock(mutex);
      blocked = false;
      changed.notify_all();
    }
    changer.join();
  };
  PLEAT_ASSERT_OK_AND_ASSIGN(const JobInfo first, jobs.Create({}));  // the workers do not run
  while_one_is_saved([&] { EXPECT_THAT(jobs.Create({}), IsOk()); },
                     [&] {
                       EXPECT_THAT(jobs.Get(first.id), IsOk());
                       EXPECT_EQ(jobs.List().size(), 1u);  // not yet saved, so not yet there
                     });
  EXPECT_EQ(jobs.List().size(), 2u);
  while_one_is_saved([&] { EXPECT_THAT(jobs.Cancel(first.id), IsOk()); },
                     [&] { EXPECT_EQ(jobs.List().size(), 2u); });
  EXPECT_EQ(jobs.Get(first.id)->state, JobState::kCancelled);
}

TEST(JobManagerTest, RefusesWhenFullOrNotSaved) {
  Journal journal;
  JobManager jobs({.max_queued = 2}, Succeeds(), journal.save());
  ASSERT_TRUE(jobs.Create(Named("a")).ok());
  journal.Fail(true);
  EXPECT_THAT(jobs.Create(Named("b")),
              HasStatus(absl::StatusCode::kResourceExhausted, HasSubstr("disk")));
  journal.Fail(false);
  ASSERT_TRUE(jobs.Create(Named("b")).ok());
  EXPECT_THAT(jobs.Create(Named("c")),
              HasStatus(absl::StatusCode::kResourceExhausted, HasSubstr("limit is 2")));
  EXPECT_EQ(jobs.List().size(), 2u);
}

}  // namespace
}  // namespace pleat
