#include "pleat/character/training_checkpoint.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>
#include <string>
#include <vector>

#include "pleat/character/train_with_rig.h"
#include "pleat/formats/checkpoint_file.h"
#include "pleat/formats/model_file.h"
#include "support/status_matchers.h"
#include "trained_performer.h"

namespace pleat {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

// One training, with all that it handed over and the stages that it reported.
struct RecordedTraining {
  std::string bytes;  // of the model
  std::vector<TrainingCheckpoint> checkpoints;
  std::set<std::string> stages;
};

RecordedTraining TrainRecorded(const TrainOptions& options, const TrainingCheckpoint* resume,
                               const UserRig* rig = nullptr) {
  RecordedTraining recorded;
  TrainResources resources;
  resources.resume = resume;
  resources.on_checkpoint = [&](const TrainingCheckpoint& checkpoint) {
    recorded.checkpoints.push_back(checkpoint);
  };
  const Progress progress(
      [&](const ProgressUpdate& update) { recorded.stages.insert(update.stage); }, nullptr);
  const std::vector<MeshSequence> clips = {SmallPerformer().sequence};
  const auto model = rig ? TrainCharacterWithRig(clips, *rig, options, resources, nullptr, progress)
                         : TrainCharacter(clips, options, resources, nullptr, progress);
  EXPECT_THAT(model, IsOk());
  if (model.ok()) recorded.bytes = EncodeModel(**model);
  return recorded;
}

// As another process has it: written and read.
TrainingCheckpoint Reread(const TrainingCheckpoint& checkpoint) {
  const std::string bytes =
      EncodeCheckpoint({.job_id = "job", .inputs = "", .checkpoint = checkpoint});
  return DecodeCheckpoint(bytes).value().checkpoint;
}

TrainOptions QuickOptions(LearnerChoice learner) {
  TrainOptions options;
  options.resolution_percent = 20;
  options.learner = learner;
  options.iterations = 20;
  return options;
}

TEST(TrainingCheckpointTest, ATrainingGoesOnFromEveryStageAndEndsWithTheSameBytes) {
  const TrainOptions options = QuickOptions(LearnerChoice::kAuto);
  const RecordedTraining whole = TrainRecorded(options, nullptr);
  ASSERT_EQ(whole.checkpoints.size(), 4u);
  EXPECT_FALSE(whole.checkpoints[0].fit);
  EXPECT_FALSE(whole.checkpoints[1].choice);
  EXPECT_EQ(whole.checkpoints[2].detail_model, nullptr);
  EXPECT_NE(whole.checkpoints[3].detail_model, nullptr);
  for (size_t i = 0; i < 4; ++i) {
    const TrainingCheckpoint checkpoint = Reread(whole.checkpoints[i]);
    const RecordedTraining rest = TrainRecorded(options, &checkpoint);
    EXPECT_TRUE(rest.bytes == whole.bytes) << "from checkpoint " << i;
    EXPECT_EQ(rest.checkpoints.size(), 3 - i);  // what was finished is not handed over again
    EXPECT_THAT(rest.stages, Not(Contains("rig")));
    EXPECT_EQ(rest.stages.contains("fit"), i < 1);
  }
}

TEST(TrainingCheckpointTest, ALearnerThatNeedsNoChoiceHandsNoChoiceOver) {
  const TrainOptions options = QuickOptions(LearnerChoice::kRegional);
  const RecordedTraining whole = TrainRecorded(options, nullptr);
  ASSERT_EQ(whole.checkpoints.size(), 3u);
  const TrainingCheckpoint checkpoint = Reread(whole.checkpoints[2]);
  EXPECT_TRUE(TrainRecorded(options, &checkpoint).bytes == whole.bytes);
}

TEST(TrainingCheckpointTest, ATrainingWithAUsersRigGoesOn) {
  const TrainOptions options = QuickOptions(LearnerChoice::kRidge);
  const UserRig rig{SmallPerformer().truth.rig.skeleton, std::nullopt, 0, {3}};
  const RecordedTraining whole = TrainRecorded(options, nullptr, &rig);
  ASSERT_EQ(whole.checkpoints.size(), 3u);
  EXPECT_THAT(whole.checkpoints[0].rigging->locked_joints, ElementsAre(3));
  for (const size_t i : {0, 1}) {
    const TrainingCheckpoint checkpoint = Reread(whole.checkpoints[i]);
    EXPECT_TRUE(TrainRecorded(options, &checkpoint, &rig).bytes == whole.bytes) << i;
  }
}

class ForeignCheckpointTest : public testing::Test {
 protected:
  ForeignCheckpointTest() {
    const int num_vertices = SmallPerformer().sequence.num_vertices();
    const Rig& rig = SmallPerformer().truth.rig;
    checkpoint_.rigging.emplace().rig = rig;
    PoseTrack::Parts parts{.poses = std::vector<Pose>(60, Pose::Rest(rig.skeleton))};
    checkpoint_.fit = {.track = PoseTrack::Create(std::move(parts)).value()};
    checkpoint_.choice = TrainingCheckpoint::Choice{};
    EXPECT_EQ(rig.rest_positions.cols(), num_vertices);
  }
  void ExpectRefused(const std::string& words) {
    TrainResources resources;
    resources.resume = &checkpoint_;
    EXPECT_THAT(TrainCharacter({SmallPerformer().sequence}, FastTrainOptions(), resources),
                HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr(words)));
  }
  TrainingCheckpoint checkpoint_;
};

TEST_F(ForeignCheckpointTest, WhatFitsIsTaken) {
  EXPECT_THAT(
      CheckTrainingCheckpoint(checkpoint_, SmallPerformer().sequence.num_vertices(), 60, 60, {0}),
      IsOk());
  EXPECT_THAT(CheckTrainingCheckpoint({}, 1, 1, 1, {0}), IsOk());
}

TEST_F(ForeignCheckpointTest, ARigOfAnotherMeshIsRefused) {
  Rig& rig = checkpoint_.rigging->rig;
  rig.rest_positions.conservativeResize(3, rig.rest_positions.cols() - 1);
  ExpectRefused("vertices");
}

TEST_F(ForeignCheckpointTest, ARestFrameBeyondTheClipIsRefused) {
  checkpoint_.rigging->rest_frame = 60;
  ExpectRefused("rest frame 60");
}

TEST_F(ForeignCheckpointTest, AJointThatIsNotThereIsRefused) {
  checkpoint_.rigging->locked_joints = {-1};
  ExpectRefused("locked joint");
}

TEST_F(ForeignCheckpointTest, PosesOfOtherFramesAreRefused) {
  checkpoint_.fit->track = checkpoint_.fit->track.Subset({0, 1, 2});
  ExpectRefused("poses of 3 frames; the clips have 60");
}

TEST_F(ForeignCheckpointTest, AStageWithoutTheOneBeforeIsRefused) {
  checkpoint_.fit.reset();
  ExpectRefused("without the one before");
}

TEST_F(ForeignCheckpointTest, ALearnerThatWasNotChosenIsRefused) {
  checkpoint_.choice->learner = LearnerChoice::kAuto;
  ExpectRefused("no learner");
}

}  // namespace
}  // namespace pleat
