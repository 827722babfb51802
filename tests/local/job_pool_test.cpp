#include "pleat/local/job_pool.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "data_folder.h"
#include "job_rows.h"
#include "pleat/local/local_jobs.h"
#include "pleat/local/retention.h"
#include "pleat/store/records.h"
#include "support/fake_training.h"
#include "support/status_matchers.h"

namespace pleat {
namespace {

// A service of jobs that can be started again and again on one folder.
class JobPoolTest : public testing::Test {
 protected:
  JobPoolTest() { folder_.Open(); }
  ~JobPoolTest() override { pool_.reset(); }

  void PutJobs(int first, int num, JobState state, int64_t ended_minutes_ago = 0) {
    std::vector<CatalogEntry> rows;
    for (int i = first; i < first + num; ++i) {
      JobInfo job;
      job.id = absl::StrCat("job-", i);
      job.name = "walk";
      job.state = state;
      job.request_id = absl::StrCat("request-", i);
      if (IsFinal(state)) job.ended = folder_.now() - absl::Minutes(ended_minutes_ago);
      rows.push_back(JobEntry(job, 1));
    }
    ASSERT_THAT(catalog().PutAll(EntryKind::kJob, rows), IsOk());
  }
  Catalog& catalog() { return folder_.files().store().catalog(); }
  // Opens the folder as a process does and starts the jobs; none of them finds its sequence.
  void Start() {
    pool_.reset();
    jobs_.reset();
    folder_.Open();
    pool_ = std::make_unique<JobPool>(
        &folder_.files(),
        [this](const std::string&) -> const JobRunner& { return jobs_->runner(); },
        JobPoolOptions{});
    jobs_ = std::make_unique<LocalJobs>(
        &folder_.files(), &folder_.sequences(),
        JobRunner(&folder_.files(), &folder_.sequences(), TrainCharacter, 1), pool_.get());
    ASSERT_THAT(pool_->Start(), IsOk());
  }

  DataFolder folder_;
  std::unique_ptr<LocalJobs> jobs_;
  std::unique_ptr<JobPool> pool_;
};

// All rows of jobs were read at each start and stayed in memory. Counted in the steps of SQLite's
// machine, so that no clock decides: reading 50,000 rows takes more than a million.
TEST_F(JobPoolTest, AStartCostsTheSameHoweverManyJobsHaveEnded) {
  PutJobs(0, 50, JobState::kSucceeded);
  Start();
  const uint64_t steps_of_few = catalog().num_read_steps();
  PutJobs(50, 49'950, JobState::kFailed);
  Start();
  const uint64_t steps_of_many = catalog().num_read_steps();
  EXPECT_LE(steps_of_many, steps_of_few + 20);  // a count for one more state
  EXPECT_LT(steps_of_many, 2000u);
  EXPECT_EQ(pool_->CountInState(JobState::kSucceeded), 50u);
  EXPECT_EQ(pool_->CountInState(JobState::kFailed), 49'950u);
  EXPECT_TRUE(pool_->manager().ListUnfinished().empty());
}

TEST_F(JobPoolTest, WhatIsAskedOfOneJobCostsTheSameHoweverManyHaveEnded) {
  const std::string sequence = folder_.sequences().Upload(MakeSwayingTube(3, "a"), {})->id;
  const auto steps = [&] {
    const uint64_t before = catalog().num_read_steps();
    EXPECT_EQ(jobs_->Get("job-7")->state, JobState::kSucceeded);
    EXPECT_EQ(pool_->manager().ListUnfinished().size(), 0u);
    EXPECT_THAT(jobs_->CreateTraining({.sequence_ids = {sequence}, .request_id = "request-9"}),
                HasStatus(absl::StatusCode::kAlreadyExists, testing::HasSubstr("job-9")));
    RunRetention({.files = &folder_.files()},
                 {.max_ended_jobs = 60'000, .max_job_age = absl::Hours(1)});
    EXPECT_EQ(jobs_->ListPage({.size = 10})->items.size(), 10u);
    return catalog().num_read_steps() - before;
  };
  PutJobs(0, 50, JobState::kSucceeded);
  Start();
  const uint64_t steps_of_few = steps();
  PutJobs(50, 49'950, JobState::kFailed, 30);
  Start();
  EXPECT_LE(steps(), steps_of_few + 100);
}

TEST_F(JobPoolTest, EveryJobThatHasEndedIsInThePages) {
  PutJobs(0, 1200, JobState::kCancelled);
  Start();
  PLEAT_ASSERT_OK_AND_ASSIGN(const std::vector<JobInfo> jobs, jobs_->List());
  ASSERT_EQ(jobs.size(), 1200u);
  EXPECT_EQ(jobs[1199].id, "job-1199");
  EXPECT_THAT(jobs_->Delete("job-600"), IsOk());
  EXPECT_EQ(pool_->CountInState(JobState::kCancelled), 1199u);
}

TEST_F(JobPoolTest, JobsThatHaveNotEndedGoOnInTheirOrder) {
  PutJobs(0, 3, JobState::kSucceeded);
  PutJobs(3, 2, JobState::kQueued);
  PutJobs(5, 1, JobState::kRunning);
  PutJobs(6, 2, JobState::kQueued);
  PLEAT_ASSERT_OK_AND_ASSIGN(const UnfinishedJobs unfinished, ReadUnfinishedJobs(&folder_.files()));
  std::vector<std::string> ids;
  for (const StoredJob& job : unfinished.jobs) ids.push_back(job.info.id);
  EXPECT_THAT(ids, testing::ElementsAre("job-3", "job-4", "job-5", "job-6", "job-7"));
  Start();
  for (const std::string& id : ids) {
    ASSERT_THAT(WatchJob(*jobs_, id, [](const JobInfo&) { return true; }), IsOk());
    EXPECT_EQ(jobs_->Get(id)->state, JobState::kFailed);
  }
}

// Rows of older versions have no columns that say what is asked most.
TEST_F(JobPoolTest, RowsOfOlderVersionsAreReadOnceForEver) {
  std::vector<CatalogEntry> rows;
  for (int i = 0; i < 2500; ++i) {
    JobInfo job;
    job.id = absl::StrCat("job-", i);
    job.state = i == 2000 ? JobState::kQueued : JobState::kSucceeded;
    job.request_id = absl::StrCat("request-", i);
    rows.push_back({job.id, EncodeRecord(job), 1});
  }
  rows[1500].record = "\xff\xff";
  ASSERT_THAT(catalog().PutAll(EntryKind::kJob, rows), IsOk());
  EXPECT_EQ(pool_, nullptr);
  PLEAT_ASSERT_OK_AND_ASSIGN(UnfinishedJobs unfinished, ReadUnfinishedJobs(&folder_.files()));
  EXPECT_FALSE(unfinished.all_rows_are_read);
  ASSERT_EQ(unfinished.jobs.size(), 1u);
  EXPECT_EQ(unfinished.jobs[0].info.id, "job-2000");
  EXPECT_EQ(unfinished.jobs[0].attempts, 1);
  EXPECT_EQ(catalog().ListUnnotedJobs(0, 10)->size(), 1u);  // the one that cannot be read
  EXPECT_THAT(folder_.problems(), testing::ElementsAre(testing::HasSubstr("job-1500")));
  Start();
  EXPECT_EQ(pool_->CountInState(JobState::kSucceeded), 2498u);
  EXPECT_EQ(catalog().FindJobOfRequest(kDefaultProject, "request-7")->id, "job-7");
}

}  // namespace
}  // namespace pleat
