#include "pleat/local/local_jobs.h"

#include <gtest/gtest.h>

#include <condition_variable>
#include <mutex>

#include "data_folder.h"
#include "pleat/base/limit_refusal.h"
#include "pleat/formats/rig_file.h"
#include "support/fake_training.h"
#include "support/status_matchers.h"

namespace pleat {
namespace {

using ::testing::_;
using ::testing::HasSubstr;

// Training that begins when it is told to, so that a test knows where its jobs are.
class GatedTraining {
 public:
  TrainFunction function() {
    return
        [this](const std::vector<MeshSequence>& clips, const TrainOptions& options,
               const TrainResources&, TrainSummary*,
               const Progress& progress) -> absl::StatusOr<std::shared_ptr<const CharacterModel>> {
          {
            std::unique_lock lock(mutex_);
            ++num_waiting_;
            changed_.notify_all();
            changed_.wait(lock, [this] { return open_; });
          }
          if (absl::Status status = progress.Report(.5); !status.ok()) return status;
          return MakeFakeModel(clips[0], options);
        };
  }
  void WaitForJobs(int count) {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [&] { return num_waiting_ >= count; });
  }
  void Release() {
    std::lock_guard lock(mutex_);
    open_ = true;
    changed_.notify_all();
  }
  int num_begun() {
    std::lock_guard lock(mutex_);
    return num_waiting_;
  }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  int num_waiting_ = 0;  // guarded by mutex_
  bool open_ = false;    // guarded by mutex_
};

class LocalJobsTest : public testing::Test {
 protected:
  LocalJobsTest() {
    folder_.Open({.max_clips = 2});
    a_ = folder_.sequences().Upload(MakeSwayingTube(5, "a"), {})->id;
    b_ = folder_.sequences().Upload(MakeSwayingTube(6, "b"), {})->id;
    pool_ = std::make_unique<JobPool>(&folder_.files(), Runners(), JobPoolOptions{});
    jobs_ = std::make_unique<LocalJobs>(
        &folder_.files(), &folder_.sequences(),
        JobRunner(&folder_.files(), &folder_.sequences(), training_.function(), 1), pool_.get());
    EXPECT_THAT(pool_->Start(), IsOk());
  }
  ~LocalJobsTest() override {
    training_.Release();
    pool_->Shutdown();
  }
  JobPool::RunnerOf Runners() {
    return [this](const std::string&) -> const JobRunner& { return jobs_->runner(); };
  }
  std::string Create(const std::string& sequence_id, const std::string& name = "") {
    return jobs_->CreateTraining({.sequence_ids = {sequence_id}, .model_name = name})->id;
  }
  JobInfo RunToEnd(const std::string& id) {
    JobInfo last;
    EXPECT_THAT(WatchJob(*jobs_, id,
                         [&](const JobInfo& info) {
                           last = info;
                           return true;
                         }),
                IsOk());
    return last;
  }
  int NumModels() {
    return static_cast<int>(folder_.files().store().catalog().List(EntryKind::kModel)->size());
  }

  DataFolder folder_;
  GatedTraining training_;
  std::string a_, b_;
  std::unique_ptr<LocalJobs> jobs_;
  std::unique_ptr<JobPool> pool_;  // ends first
};

TEST_F(LocalJobsTest, JobsAreListedInTheirOrderUnderTheNameOfTheirResult) {
  const std::string first = Create(a_), second = Create(b_, "mine");
  const std::string third = jobs_->CreateCompression({a_, {}})->id;
  PLEAT_ASSERT_OK_AND_ASSIGN(const std::vector<JobInfo> list, jobs_->List());
  ASSERT_EQ(list.size(), 3u);
  EXPECT_EQ(list[0].id, first);
  EXPECT_EQ(list[0].name, "a");
  EXPECT_EQ(list[1].id, second);
  EXPECT_EQ(list[1].name, "mine");
  EXPECT_EQ(list[2].id, third);
  EXPECT_EQ(list[2].name, "a");
  EXPECT_TRUE(std::holds_alternative<CompressOptions>(list[2].options));
  EXPECT_EQ(jobs_->Get(second)->sequence_ids, std::vector<std::string>{b_});
}

TEST_F(LocalJobsTest, AJobThatRunsIsCancelledAtItsNextReport) {
  const std::string running = Create(a_);
  training_.WaitForJobs(1);
  EXPECT_EQ(jobs_->Get(running)->state, JobState::kRunning);
  EXPECT_THAT(jobs_->Cancel(running), IsOk());
  training_.Release();
  EXPECT_EQ(RunToEnd(running).state, JobState::kCancelled);
  EXPECT_EQ(NumModels(), 0);
  EXPECT_THAT(jobs_->Cancel(running), HasStatus(absl::StatusCode::kFailedPrecondition, _));
}

TEST_F(LocalJobsTest, AJobThatWaitsIsCancelledWithoutEverRunning) {
  const std::string running = Create(a_), waiting = Create(b_);
  training_.WaitForJobs(1);
  EXPECT_THAT(jobs_->Cancel(waiting), IsOk());
  EXPECT_EQ(jobs_->Get(waiting)->state, JobState::kCancelled);
  training_.Release();
  EXPECT_EQ(RunToEnd(running).state, JobState::kSucceeded);
  EXPECT_EQ(RunToEnd(Create(b_)).state, JobState::kSucceeded);
  EXPECT_EQ(training_.num_begun(), 2);
  EXPECT_EQ(NumModels(), 2);
}

TEST_F(LocalJobsTest, UnknownIdsAreNotFound) {
  for (const std::string& id : {std::string(), std::string("job"), std::string(64, '0')}) {
    EXPECT_THAT(jobs_->Get(id), HasStatus(absl::StatusCode::kNotFound, _)) << id;
    EXPECT_THAT(jobs_->Cancel(id), HasStatus(absl::StatusCode::kNotFound, _)) << id;
    EXPECT_THAT(jobs_->Subscribe(id, [] {}), HasStatus(absl::StatusCode::kNotFound, _)) << id;
    EXPECT_THAT(jobs_->CreateCompression({id, {}}), HasStatus(absl::StatusCode::kNotFound, _))
        << id;
    EXPECT_THAT(jobs_->CreateTraining({.sequence_ids = {a_, id}}),
                HasStatus(absl::StatusCode::kNotFound, _))
        << id;
  }
  EXPECT_TRUE(jobs_->List()->empty());
}

TEST_F(LocalJobsTest, WhatCannotSucceedIsRefusedBeforeThereIsAJob) {
  const auto refused = [&](const TrainingRequest& request, const std::string& words) {
    EXPECT_THAT(jobs_->CreateTraining(request),
                HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr(words)));
  };
  refused({.sequence_ids = {}}, "1 to 2 sequences, not 0");
  refused({.sequence_ids = {a_, b_, a_}}, "1 to 2 sequences, not 3");
  refused({.sequence_ids = {a_}, .options = {.history = 0}}, "history");
  refused({.sequence_ids = {a_}, .rig = "no rig"}, "");
  const Rig known = MakeFakeModel(MakeSwayingTube(5, "a"), {})->rig();
  refused({.sequence_ids = {a_}, .rig = EncodeRig({known.skeleton, known.weights, 5, {}})},
          "rest_frame 5 of 'a', which has 5 frames");
  const Rig other = MakeFakeModel(MakeSwayingTube(5, "x", 13), {})->rig();
  refused({.sequence_ids = {a_}, .rig = EncodeRig({other.skeleton, other.weights, 0, {}})},
          "weights of 104 vertices; 'a' has 96");
  refused({.sequence_ids = {a_},
           .options = {.placed_joints = {{.joint = 1}}},
           .rig = EncodeRig({known.skeleton, known.weights, 0, {}})},
          "placed_joints");
  EXPECT_THAT(jobs_->CreateCompression({a_, {.max_error_mm = -1}}),
              HasStatus(absl::StatusCode::kInvalidArgument, _));
  EXPECT_TRUE(jobs_->List()->empty());
  EXPECT_TRUE(folder_.files().store().catalog().List(EntryKind::kRig)->empty());
}

TEST_F(LocalJobsTest, AProjectThatHasUsedUpItsProcessorTimeIsToldWhenToComeAgain) {
  ProjectQuota quota(ProjectQuota::OfJobTime(kDefaultProject, 3600), [] { return 0.; });
  LocalJobs jobs(&folder_.files(), &folder_.sequences(),
                 JobRunner(&folder_.files(), &folder_.sequences(), training_.function(), 1),
                 pool_.get(), &quota);
  EXPECT_THAT(jobs.CreateTraining({.sequence_ids = {a_}}), IsOk());
  quota.Charge(3660);
  for (const absl::Status& status : {jobs.CreateTraining({.sequence_ids = {a_}}).status(),
                                     jobs.CreateCompression({a_, {}}).status()}) {
    const auto refusal = LimitRefusalOf(status);
    ASSERT_TRUE(refusal) << status;
    EXPECT_EQ(refusal->subject, "project:default");
    EXPECT_EQ(refusal->limit, "--project-job-cpu-seconds-per-hour");
    EXPECT_EQ(refusal->retry_after, absl::Seconds(61));
  }
  EXPECT_EQ(jobs.List()->size(), 1u);
}

// Counts what a listener hears, and lets a test wait for it.
class Counter {
 public:
  std::function<void()> function() {
    return [this] {
      std::lock_guard lock(mutex_);
      ++count_;
      changed_.notify_all();
    };
  }
  int count() {
    std::lock_guard lock(mutex_);
    return count_;
  }
  void WaitForMoreThan(int count) {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [&] { return count_ > count; });
  }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  int count_ = 0;  // guarded by mutex_
};

TEST_F(LocalJobsTest, ObserversHearOfChangesUntilTheyLeave) {
  const std::string running = Create(a_), waiting = Create(b_);
  training_.WaitForJobs(1);
  Counter stays, leaves;
  PLEAT_ASSERT_OK_AND_ASSIGN(const auto first, jobs_->Subscribe(waiting, stays.function()));
  PLEAT_ASSERT_OK_AND_ASSIGN(auto second, jobs_->Subscribe(waiting, leaves.function()));
  const JobUpdate before = first->current();
  EXPECT_EQ(before.info.state, JobState::kQueued);
  EXPECT_THAT(first->status(), IsOk());
  second.reset();
  const int heard = leaves.count();
  EXPECT_THAT(jobs_->Cancel(waiting), IsOk());
  stays.WaitForMoreThan(0);
  EXPECT_EQ(leaves.count(), heard);
  const JobUpdate after = first->current();
  EXPECT_EQ(after.info.state, JobState::kCancelled);
  EXPECT_GT(after.revision, before.revision);
}

TEST_F(LocalJobsTest, AShutdownEndsSubscriptionsAndTakesNoMoreJobs) {
  Create(a_);
  const std::string waiting = Create(b_);
  training_.WaitForJobs(1);
  Counter counter;
  PLEAT_ASSERT_OK_AND_ASSIGN(const auto subscription,
                             jobs_->Subscribe(waiting, counter.function()));
  training_.Release();
  pool_->Shutdown();
  EXPECT_GT(counter.count(), 0);
  EXPECT_THAT(subscription->status(), HasStatus(absl::StatusCode::kUnavailable, _));
  EXPECT_THAT(jobs_->CreateCompression({a_, {}}), HasStatus(absl::StatusCode::kUnavailable, _));
  pool_->Shutdown();  // once more does no harm
}

TEST_F(LocalJobsTest, ARecordThatCannotBeReadStopsNoStart) {
  pool_->Shutdown();
  ASSERT_THAT(folder_.files().catalog().Put(EntryKind::kJob, {"broken", "\xff\xff\xff"}), IsOk());
  JobPool again(&folder_.files(), Runners(), JobPoolOptions{});
  EXPECT_THAT(again.Start(), IsOk());
  EXPECT_THAT(folder_.problems(), testing::ElementsAre(HasSubstr("the job 'broken'")));
}

}  // namespace
}  // namespace pleat
