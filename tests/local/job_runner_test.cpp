#include "pleat/local/job_runner.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>

#include "data_folder.h"
#include "pleat/character/character_model.h"
#include "pleat/formats/rig_file.h"
#include "support/fake_training.h"
#include "support/status_matchers.h"

namespace pleat {
namespace {

using ::testing::_;
using ::testing::HasSubstr;

class JobRunnerTest : public testing::Test {
 protected:
  JobRunnerTest() {
    Open();
    sequence_id_ = folder_.sequences().Upload(tube_, {})->id;
  }
  void Open(const ServiceLimits& limits = {}) {
    runner_.reset();
    folder_.Open(limits);
    runner_ =
        std::make_unique<JobRunner>(&folder_.files(), &folder_.sequences(), trainer_.function(), 1);
  }
  JobInfo Job(JobOptions options) const {
    JobInfo job;
    job.name = "tube";
    job.sequence_ids = {sequence_id_};
    job.options = std::move(options);
    return job;
  }
  size_t NumStored(EntryKind kind) { return folder_.files().store().catalog().List(kind)->size(); }
  size_t NumResults() {
    return NumStored(EntryKind::kModel) + NumStored(EntryKind::kCompressedSequence);
  }
  void DeleteResults() {
    for (const EntryKind kind : {EntryKind::kModel, EntryKind::kCompressedSequence}) {
      const std::vector<CatalogEntry> entries =
          folder_.files().store().catalog().List(kind).value();
      for (const CatalogEntry& entry : entries) {
        ASSERT_THAT(folder_.files().Delete(kind, entry.id), IsOk());
      }
    }
  }

  DataFolder folder_;
  FakeTrainer trainer_;
  std::unique_ptr<JobRunner> runner_;
  const MeshSequence tube_ = MakeSwayingTube(5);
  std::string sequence_id_;
};

struct Kind {
  const char* name;
  JobOptions options;
};

class JobKindsTest : public JobRunnerTest, public testing::WithParamInterface<Kind> {};

INSTANTIATE_TEST_SUITE_P(Kinds, JobKindsTest,
                         testing::Values(Kind{"Training", TrainOptions()},
                                         Kind{"Compression", CompressOptions()}),
                         [](const auto& info) { return std::string(info.param.name); });

// A cancellation at any report, that is in any stage, ends the job and leaves nothing behind. Only
// the last report comes too late: nothing but storing the result is left.
TEST_P(JobKindsTest, CanBeCancelledAtEveryStage) {
  std::vector<ProgressUpdate> reports;
  // Runs the job and cancels it during its report `last`.
  const auto run_until = [&](size_t last) {
    bool cancelled = false;
    reports.clear();
    const Progress progress(
        [&](const ProgressUpdate& update) {
          reports.push_back(update);
          cancelled = reports.size() == last + 1;
        },
        [&] { return cancelled; });
    return runner_->Run(Job(GetParam().options), progress).status();
  };
  ASSERT_THAT(run_until(1 << 30), IsOk());
  const std::vector<ProgressUpdate> whole = reports;
  EXPECT_EQ(whole.front().stage, "read");
  EXPECT_EQ(whole.back().stage, "store");
  EXPECT_GT(whole.size(), 4u);
  EXPECT_TRUE(std::is_sorted(whole.begin(), whole.end(),
                             [](const auto& a, const auto& b) { return a.fraction < b.fraction; }));
  EXPECT_EQ(NumResults(), 1u);
  DeleteResults();
  for (size_t last = 0; last + 1 < whole.size(); ++last) {
    EXPECT_THAT(run_until(last), HasStatus(absl::StatusCode::kCancelled, _)) << whole[last].stage;
    EXPECT_EQ(reports.size(), last + 1) << "reported after the cancellation";
    EXPECT_EQ(NumResults(), 0u) << whole[last].stage;
  }
}

TEST_P(JobKindsTest, ErrorsOfTheStoreAreThoseOfTheJob) {
  // The result cannot be stored.
  const std::string result_id = runner_->Run(Job(GetParam().options), {})->result_id;
  DeleteResults();
  ASSERT_NE(result_id.substr(0, 2), sequence_id_.substr(0, 2));
  folder_.Block(result_id);
  EXPECT_THAT(runner_->Run(Job(GetParam().options), {}).status().message(),
              HasSubstr("cannot create"));
  EXPECT_EQ(NumResults(), 0u);
  // A byte of the sequence has changed on the disk.
  std::ofstream(folder_.PathOf(sequence_id_), std::ios::in | std::ios::binary).seekp(60).put('?');
  EXPECT_THAT(runner_->Run(Job(GetParam().options), {}),
              HasStatus(absl::StatusCode::kDataLoss, HasSubstr("changed on the disk")));
  std::filesystem::remove(folder_.PathOf(sequence_id_));
  EXPECT_THAT(runner_->Run(Job(GetParam().options), {}),
              HasStatus(absl::StatusCode::kNotFound, HasSubstr(sequence_id_)));
  ASSERT_THAT(folder_.sequences().Delete(sequence_id_), IsOk());
  EXPECT_THAT(runner_->Run(Job(GetParam().options), {}), HasStatus(absl::StatusCode::kNotFound, _));
  EXPECT_EQ(NumResults(), 0u);
}

// The limits may have been lowered since the sequence came in.
TEST_P(JobKindsTest, LimitsHoldForWhatIsStoredToo) {
  Open({.max_frames = 4});
  EXPECT_FALSE(runner_->Run(Job(GetParam().options), {}).ok());
  EXPECT_EQ(NumResults(), 0u);
}

TEST_P(JobKindsTest, TheSameJobTwiceIsStoredOnce) {
  PLEAT_ASSERT_OK_AND_ASSIGN(const JobOutcome first, runner_->Run(Job(GetParam().options), {}));
  PLEAT_ASSERT_OK_AND_ASSIGN(const JobOutcome second, runner_->Run(Job(GetParam().options), {}));
  EXPECT_EQ(first.result_id, second.result_id);
  EXPECT_EQ(NumResults(), 1u);
}

TEST_F(JobRunnerTest, AFailedTrainingPassesItsReasonOn) {
  EXPECT_THAT(runner_->Run(Job(TrainOptions{.iterations = 13}), {}),
              HasStatus(absl::StatusCode::kFailedPrecondition, "no human-like rig fits"));
  EXPECT_EQ(NumResults(), 0u);
}

TEST_F(JobRunnerTest, UserRigsAreReadUnderTheLimitsOfTheService) {
  const Rig known = MakeFakeModel(tube_, {})->rig();
  const std::string text = EncodeRig({known.skeleton, known.weights, 0, {}});
  PLEAT_ASSERT_OK_AND_ASSIGN(const RigFile rig, runner_->DecodeUserRig(text));
  EXPECT_EQ(rig.skeleton.num_joints(), 3);
  EXPECT_THAT(runner_->DecodeUserRig("{"), HasStatus(absl::StatusCode::kInvalidArgument, _));
  Open({.max_rig_bytes = 100});
  EXPECT_FALSE(runner_->DecodeUserRig(text).ok());
  Open({.max_vertices = 95});  // one less than the weights have
  EXPECT_FALSE(runner_->DecodeUserRig(text).ok());
  // A job whose rig is gone.
  Open();
  JobInfo job = Job(TrainOptions());
  job.rig_id = std::string(64, 'b');
  EXPECT_THAT(runner_->Run(job, {}), HasStatus(absl::StatusCode::kNotFound, _));
}

}  // namespace
}  // namespace pleat
