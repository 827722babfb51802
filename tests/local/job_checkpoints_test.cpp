#include "job_checkpoints.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <memory>
#include <string>
#include <vector>

#include "data_folder.h"
#include "job_rows.h"
#include "pleat/formats/checkpoint_file.h"
#include "pleat/local/describe_file.h"
#include "pleat/local/job_pool.h"
#include "pleat/local/job_runner.h"
#include "pleat/store/records.h"
#include "support/fake_training.h"
#include "support/status_matchers.h"

namespace pleat {
namespace {

using ::testing::_;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

// The first `num_stages` stages of a training of MakeFakeModel.
TrainingCheckpoint FakeCheckpoint(const MeshSequence& clip, int num_stages) {
  const auto model = MakeFakeModel(clip, {});
  TrainingCheckpoint checkpoint;
  checkpoint.rigging.emplace().rig = model->rig();
  if (num_stages < 2) return checkpoint;
  PoseTrack::Parts track{.poses = std::vector<Pose>(static_cast<size_t>(clip.num_frames()),
                                                    Pose::Rest(model->skeleton()))};
  checkpoint.fit = {.track = PoseTrack::Create(std::move(track)).value()};
  return checkpoint;
}

// Training in two stages, which ends after a number of them as a process that is stopped does.
struct StagedTraining {
  int num_stages = 2;               // that it gets done
  std::vector<int> resumed_from{};  // by run: stages that were done, -1 for none
  absl::Status error_when_resumed{};

  TrainFunction function() {
    return [this](const std::vector<MeshSequence>& clips, const TrainOptions& options,
                  const TrainResources& resources, TrainSummary*,
                  const Progress&) -> absl::StatusOr<std::shared_ptr<const CharacterModel>> {
      const int done = !resources.resume ? 0 : resources.resume->fit ? 2 : 1;
      resumed_from.push_back(done);
      if (done > 0 && !error_when_resumed.ok()) return error_when_resumed;
      for (int stage = done + 1; stage <= num_stages; ++stage) {
        resources.on_checkpoint(FakeCheckpoint(clips[0], stage));
      }
      if (num_stages < 2) return absl::CancelledError("the process ends");
      return MakeFakeModel(clips[0], options);
    };
  }
};

class JobCheckpointsTest : public testing::Test {
 protected:
  JobCheckpointsTest() {
    folder_.Open();
    job_.id = "job-1";
    job_.name = "tube";
    job_.state = JobState::kRunning;
    job_.sequence_ids = {folder_.sequences().Upload(tube_, {})->id};
    job_.options = TrainOptions();
  }
  absl::Status Run() {
    const JobRunner runner(&folder_.files(), &folder_.sequences(), training_.function(), 1);
    return runner.Run(job_, {}).status();
  }
  // Runs the job until its first stage is done.
  void Interrupt() {
    training_.num_stages = 1;
    EXPECT_THAT(Run(), HasStatus(absl::StatusCode::kCancelled, _));
    training_.num_stages = 2;
  }
  Store& store() { return folder_.files().store(); }
  std::vector<CatalogEntry> Stored() {
    return store().catalog().List(EntryKind::kCheckpoint).value();
  }
  absl::Status SaveRow(JobState state) {
    job_.state = state;
    return JobRows(&folder_.files(), {}).Save(job_, 1);
  }

  DataFolder folder_;
  StagedTraining training_;
  const MeshSequence tube_ = MakeSwayingTube(5);
  JobInfo job_;
};

TEST_F(JobCheckpointsTest, AJobThatWasInterruptedGoesOn) {
  const uint64_t bytes_before = store().catalog().ProjectBytes(kDefaultProject).value();
  Interrupt();
  const std::vector<CatalogEntry> stored = Stored();
  ASSERT_EQ(stored.size(), 1u);
  EXPECT_EQ(store().catalog().ProjectBytes(kDefaultProject).value(),
            bytes_before + stored[0].file_bytes);  // it counts as what the project stores
  folder_.Open();
  EXPECT_THAT(Run(), IsOk());
  EXPECT_THAT(training_.resumed_from, ElementsAre(0, 1));
  EXPECT_THAT(folder_.problems(), IsEmpty());
}

TEST_F(JobCheckpointsTest, ThereIsOneAtATimeAndNoneWhenTheJobHasEnded) {
  ASSERT_THAT(SaveRow(JobState::kRunning), IsOk());
  EXPECT_THAT(Run(), IsOk());
  const std::vector<CatalogEntry> stored = Stored();
  ASSERT_EQ(stored.size(), 1u);
  EXPECT_EQ(DecodeCheckpointRecord(stored[0].record)->job_id, "job-1");
  PLEAT_ASSERT_OK_AND_ASSIGN(const std::string bytes, store().Read(stored[0].id));
  EXPECT_TRUE(DecodeCheckpoint(bytes)->checkpoint.fit.has_value());  // the second one
  const std::string path = folder_.PathOf(stored[0].id);
  EXPECT_TRUE(std::filesystem::exists(path));
  ASSERT_THAT(SaveRow(JobState::kSucceeded), IsOk());
  EXPECT_THAT(Stored(), IsEmpty());
  EXPECT_FALSE(std::filesystem::exists(path));
}

TEST_F(JobCheckpointsTest, AJobThatIsCancelledWhileItWaitsLeavesNothing) {
  Interrupt();
  ASSERT_THAT(SaveRow(JobState::kQueued), IsOk());
  EXPECT_EQ(Stored().size(), 1u);
  ASSERT_THAT(SaveRow(JobState::kCancelled), IsOk());
  EXPECT_THAT(Stored(), IsEmpty());
}

// Two jobs may do the same, and the end of one must not take the checkpoint of the other.
TEST_F(JobCheckpointsTest, EachJobHasItsOwn) {
  Interrupt();
  job_.id = "job-2";
  Interrupt();
  EXPECT_EQ(Stored().size(), 2u);
  ASSERT_THAT(SaveRow(JobState::kFailed), IsOk());
  ASSERT_EQ(Stored().size(), 1u);
  job_.id = "job-1";
  EXPECT_THAT(Run(), IsOk());
  EXPECT_THAT(training_.resumed_from, ElementsAre(0, 0, 1));
}

TEST_F(JobCheckpointsTest, OneOfOtherInputsIsIgnored) {
  Interrupt();
  job_.options = TrainOptions{.seed = 2};
  EXPECT_THAT(Run(), IsOk());
  EXPECT_THAT(training_.resumed_from, ElementsAre(0, 0));
  EXPECT_THAT(folder_.problems(),
              ElementsAre(testing::AllOf(HasSubstr("job-1"), HasSubstr("begins anew"))));
  EXPECT_EQ(Stored().size(), 1u);
}

TEST_F(JobCheckpointsTest, OneThatIsDamagedIsIgnored) {
  Interrupt();
  std::ofstream(folder_.PathOf(Stored()[0].id), std::ios::app) << "x";
  EXPECT_THAT(Run(), IsOk());
  EXPECT_THAT(training_.resumed_from, ElementsAre(0, 0));
  EXPECT_THAT(folder_.problems(), testing::Contains(HasSubstr("begins anew")));
  EXPECT_EQ(Stored().size(), 1u);  // the new one
}

// What a program can read and still not use: the job begins anew and its own error is what counts.
TEST_F(JobCheckpointsTest, OneThatLeadsToAnErrorIsIgnored) {
  Interrupt();
  training_.error_when_resumed = absl::InvalidArgumentError("checkpoint: a rig of 7 vertices");
  EXPECT_THAT(Run(), IsOk());
  EXPECT_THAT(training_.resumed_from, ElementsAre(0, 1, 0));
  EXPECT_THAT(folder_.problems(), ElementsAre(HasSubstr("a rig of 7 vertices")));
}

TEST_F(JobCheckpointsTest, ACancellationKeepsIt) {
  Interrupt();
  training_.error_when_resumed = absl::CancelledError("the process ends again");
  EXPECT_THAT(Run(), HasStatus(absl::StatusCode::kCancelled, _));
  EXPECT_EQ(Stored().size(), 1u);
}

// A crash between the two steps of a save leaves both.
TEST_F(JobCheckpointsTest, OfTwoTheNewerCounts) {
  Interrupt();
  const std::vector<CatalogEntry> first = Stored();
  PLEAT_ASSERT_OK_AND_ASSIGN(const std::string bytes, store().Read(first[0].id));
  EXPECT_THAT(Run(), IsOk());
  ASSERT_THAT(folder_.files().Delete(EntryKind::kCheckpoint, Stored()[0].id), IsOk());
  ASSERT_THAT(folder_.files().Add(EntryKind::kCheckpoint, {first[0].id, first[0].record}, bytes),
              IsOk());
  JobCheckpoints checkpoints(&folder_.files(), job_);
  checkpoints.Save(FakeCheckpoint(tube_, 2));
  ASSERT_EQ(Stored().size(), 1u);
  ASSERT_THAT(folder_.files().Add(EntryKind::kCheckpoint, {first[0].id, first[0].record}, bytes),
              IsOk());
  EXPECT_FALSE(checkpoints.Load()->fit);  // the one that came last
  EXPECT_EQ(Stored().size(), 1u);
}

TEST_F(JobCheckpointsTest, AJobGoesOnWithoutRoomForOne) {
  auto files = std::make_unique<StoredFiles>(
      Store::Open({.data_dir = folder_.path() + "/small", .reserve_bytes = 0}).value(),
      ServiceLimits(), SystemTime, StoredFilesOptions{.max_bytes = 1});
  JobCheckpoints checkpoints(files.get(), job_);
  checkpoints.Save(FakeCheckpoint(tube_, 1));
  EXPECT_FALSE(checkpoints.Load());
  EXPECT_THAT(files->store().catalog().List(EntryKind::kCheckpoint).value(), IsEmpty());
}

TEST_F(JobCheckpointsTest, AStartRemovesThoseOfJobsThatHaveEnded) {
  Interrupt();
  job_.id = "job-2";
  Interrupt();
  ASSERT_THAT(SaveRow(JobState::kRunning), IsOk());
  // The end of job-1 was saved, and the process ended before its checkpoint went.
  folder_.Open();
  const JobRunner runner(&folder_.files(), &folder_.sequences(), training_.function(), 1);
  {
    JobPool pool(&folder_.files(), [&](const std::string&) -> const JobRunner& { return runner; },
                 {});
    ASSERT_THAT(pool.Start(), IsOk());
    for (const CatalogEntry& entry : Stored()) {
      EXPECT_EQ(DecodeCheckpointRecord(entry.record)->job_id, "job-2");
    }
    const auto job = pool.manager().Find("job-2").value();
    JobSnapshot snapshot = job->snapshot();
    while (!IsFinal(snapshot.info.state)) snapshot = job->WaitForChange(snapshot.revision, 1);
    EXPECT_EQ(snapshot.info.state, JobState::kSucceeded);
  }
  EXPECT_THAT(training_.resumed_from, ElementsAre(0, 0, 1));
  EXPECT_THAT(Stored(), IsEmpty());
  EXPECT_THAT(folder_.problems(), IsEmpty());
}

TEST_F(JobCheckpointsTest, ARepairKnowsOne) {
  Interrupt();
  const std::string id = Stored()[0].id;
  PLEAT_ASSERT_OK_AND_ASSIGN(const std::string bytes, store().Read(id));
  PLEAT_ASSERT_OK_AND_ASSIGN(const FileDescription description, DescribeStoredFile(id, bytes));
  EXPECT_EQ(description.kind, EntryKind::kCheckpoint);
  EXPECT_EQ(description.record, Stored()[0].record);
}

}  // namespace
}  // namespace pleat
