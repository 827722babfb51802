#include "pleat/character/train_character.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <map>

#include "absl/strings/str_replace.h"
#include "pleat/formats/model_file.h"
#include "pleat/mesh/frame_jumps.h"
#include "pleat/skeleton/human_template.h"
#include "support/status_matchers.h"
#include "trained_performer.h"

namespace pleat {
namespace {

using ::testing::HasSubstr;

TEST(TrainCharacterTest, DetailTakesMostOfWhatSkinningLeaves) {
  const TrainingRecord& record = SmallCharacter()->record();
  EXPECT_GT(record.fit.mean_percent, 0.1);  // the skirt swings: skinning cannot follow
  EXPECT_LT(record.reconstruction.mean_percent, 0.15 * record.fit.mean_percent);
  EXPECT_LE(record.reconstruction.mean_percent, record.reconstruction.rms_percent);
  EXPECT_LE(record.reconstruction.p95_percent, record.reconstruction.max_percent);
  EXPECT_EQ(record.num_frames, 60);
  EXPECT_EQ(record.learner, "gp");
}

TEST(TrainCharacterTest, LivelyMotionHasNoJumpsAndClipsThatJumpAreRefusedUnlessAllowed) {
  const MeshSequence& clip = SmallPerformer().sequence;
  EXPECT_TRUE(FindFrameJumps(clip).empty());
  std::vector<Eigen::Matrix3Xf> frames;
  for (int t = 0; t < clip.num_frames(); ++t) frames.push_back(clip.frame(t));
  frames[7] *= 100;
  PLEAT_ASSERT_OK_AND_ASSIGN(const MeshSequence jumping,
                             MeshSequence::Create(clip.topology(), frames, {.name = "jumping"}));
  EXPECT_THAT(TrainCharacter({clip, jumping}, FastTrainOptions()),
              HasStatus(absl::StatusCode::kFailedPrecondition,
                        testing::AllOf(HasSubstr("'jumping'"), HasSubstr("frame 7 is "))));
  TrainOptions allowing = FastTrainOptions();
  allowing.jumps = JumpPolicy::kAllow;
  const Progress stop_when_rigging(nullptr, [] { return true; });
  EXPECT_THAT(TrainCharacter({clip, jumping}, allowing, {}, nullptr, stop_when_rigging),
              HasStatus(absl::StatusCode::kCancelled, testing::_));
  // A caller who has looked through the clips is believed, and nothing is searched twice.
  EXPECT_THAT(TrainCharacter({clip, jumping}, FastTrainOptions(),
                             {.clips_are_known_without_jumps = true}, nullptr, stop_when_rigging),
              HasStatus(absl::StatusCode::kCancelled, testing::_));
}

TEST(TrainCharacterTest, ReportsWorstFramesAndJoints) {
  const TrainingRecord& record = SmallCharacter()->record();
  ASSERT_EQ(record.worst_frames.size(), 5u);
  EXPECT_GT(record.worst_frames[0].mean_percent, record.fit.mean_percent);
  for (size_t i = 1; i < 5; ++i) {
    EXPECT_GE(record.worst_frames[i - 1].mean_percent, record.worst_frames[i].mean_percent);
    EXPECT_EQ(record.worst_frames[i].clip, 0);
  }
  // The skirt hangs on hips and thighs; forearms and head are skinned exactly.
  const auto error_of = [&](const char* joint) {
    return record.joint_fit_percent[SmallCharacter()->skeleton().FindJoint(joint)];
  };
  ASSERT_EQ(record.joint_fit_percent.size(), static_cast<size_t>(kNumHumanJoints));
  EXPECT_GT(error_of("leftUpperLeg"), 1.5 * error_of("leftLowerArm"));
  EXPECT_GT(error_of("rightUpperLeg"), 1.5 * error_of("head"));
  EXPECT_EQ(record.unsmoothed_jitter_degrees, record.pose_jitter_degrees);
  EXPECT_NEAR(record.unsmoothed_rms_percent, record.fit.rms_percent, 1e-3);
}

TEST(TrainCharacterTest, SmoothingReportsItsCost) {
  TrainOptions options = FastTrainOptions();
  options.smoothness = 0.1;
  PLEAT_ASSERT_OK_AND_ASSIGN(const auto model,
                             TrainCharacter({SmallPerformer().sequence}, options));
  const TrainingRecord& record = model->record();
  EXPECT_LT(record.pose_jitter_degrees, record.unsmoothed_jitter_degrees);
  EXPECT_GT(record.fit.rms_percent, record.unsmoothed_rms_percent);
  EXPECT_LT(record.fit.rms_percent, 1.2 * record.unsmoothed_rms_percent);
}

TEST(TrainCharacterTest, FindsTheJointsOfTheTruth) {
  const Skeleton& found = SmallCharacter()->skeleton();
  const Skeleton& truth = SmallPerformer().truth.rig.skeleton;
  double sum_m = 0;
  for (int j = 0; j < kNumHumanJoints; ++j) {
    EXPECT_EQ(found.joint(j).name, truth.joint(j).name);
    sum_m += (found.rest_position(j) - truth.rest_position(j)).norm();
  }
  EXPECT_LT(sum_m / kNumHumanJoints, 0.05 * 1.7);  // of the body height
  // The performer faces +z, so its left is +x.
  EXPECT_GT(found.rest_position(kLeftHand).x(), found.rest_position(kRightHand).x());
}

class TrainThreadsTest : public ::testing::TestWithParam<LearnerChoice> {};

TEST_P(TrainThreadsTest, SameBytesForAnyThreadCount) {
  TrainOptions options;
  options.resolution_percent = 20;
  options.learner = GetParam();
  options.iterations = 30;
  std::string first;
  for (const int num_threads : {1, 2, 7}) {
    PLEAT_ASSERT_OK_AND_ASSIGN(
        const auto model,
        TrainCharacter({SmallPerformer().sequence}, options, {.num_threads = num_threads}));
    const std::string bytes = EncodeModel(*model);
    if (first.empty()) first = bytes;
    EXPECT_TRUE(bytes == first) << num_threads << " threads give another model";
  }
}

INSTANTIATE_TEST_SUITE_P(Learners, TrainThreadsTest,
                         ::testing::Values(LearnerChoice::kAuto, LearnerChoice::kRegional,
                                           LearnerChoice::kGp, LearnerChoice::kSgplvm,
                                           LearnerChoice::kBackConstrained, LearnerChoice::kRidge),
                         [](const auto& info) {
                           return absl::StrReplaceAll(ChoiceName(info.param), {{"-", "_"}});
                         });

TEST(TrainCharacterTest, AutoRecordsWhatItChoseBy) {
  TrainOptions options = FastTrainOptions();
  options.learner = LearnerChoice::kAuto;
  options.iterations = 20;
  PLEAT_ASSERT_OK_AND_ASSIGN(const auto model,
                             TrainCharacter({SmallPerformer().sequence}, options));
  const TrainingRecord& record = model->record();
  EXPECT_EQ(record.validation.num_held_out_frames, 12);  // a fifth of 60 frames
  ASSERT_GE(record.validation.mean_percent.size(), 3u);
  const double chosen = record.validation.mean_percent.at(record.learner);
  for (const auto& [learner, percent] : record.validation.mean_percent) {
    EXPECT_GE(percent, chosen) << learner;
  }
  EXPECT_EQ(SmallCharacter()->record().validation.num_held_out_frames, 0);  // it was told
}

TEST(TrainCharacterTest, EveryLearnerTrainsAndIsNamedInTheRecord) {
  for (const std::string& learner : LearnerNames()) {
    TrainOptions options = FastTrainOptions();
    PLEAT_ASSERT_OK_AND_ASSIGN(options.learner, ParseChoice<LearnerChoice>("learner", learner));
    PLEAT_ASSERT_OK_AND_ASSIGN(const auto model,
                               TrainCharacter({SmallPerformer().sequence}, options));
    EXPECT_EQ(model->record().learner, learner);
    const double share = learner == "ridge" ? .7 : .15;  // a linear map cannot follow
    EXPECT_LT(model->record().reconstruction.mean_percent, share * model->record().fit.mean_percent)
        << learner;
  }
}

TEST(TrainCharacterTest, DifferentialDetailsComeBackAsOffsets) {
  TrainOptions options = FastTrainOptions();
  options.detail_coordinates = DetailCoordinates::kDifferential;
  for (const double percent : {100., 20.}) {
    options.resolution_percent = percent;
    PLEAT_ASSERT_OK_AND_ASSIGN(const auto model,
                               TrainCharacter({SmallPerformer().sequence}, options));
    EXPECT_LT(model->record().reconstruction.mean_percent, 0.25 * model->record().fit.mean_percent);
    // Not by chance the same as learning the offsets.
    EXPECT_NE(model->record().reconstruction.mean_percent,
              SmallCharacter()->record().reconstruction.mean_percent);
  }
}

TEST(TrainCharacterTest, TheFullDeformationIsLearnedTooAndLessWell) {
  TrainOptions options = FastTrainOptions();
  options.deformation = DetailBase::kRoot;
  PLEAT_ASSERT_OK_AND_ASSIGN(const auto model,
                             TrainCharacter({SmallPerformer().sequence}, options));
  const TrainingRecord& record = model->record();
  EXPECT_EQ(record.fit.mean_percent, SmallCharacter()->record().fit.mean_percent);
  EXPECT_LT(record.reconstruction.mean_percent, record.fit.mean_percent);
  EXPECT_GT(record.reconstruction.mean_percent,
            SmallCharacter()->record().reconstruction.mean_percent);
}

TEST(TrainCharacterTest, PaperPresetTrainsOnTheControlMesh) {
  TrainSummary summary;
  PLEAT_ASSERT_OK_AND_ASSIGN(const auto model, TrainCharacter({SmallPerformer().sequence},
                                                              TrainOptions::Paper(), {}, &summary));
  EXPECT_EQ(summary.num_control_vertices,
            static_cast<int>(std::lround(0.05 * model->num_vertices())));
  EXPECT_EQ(model->record().learner, "sgplvm");
  EXPECT_LT(model->record().reconstruction.mean_percent, model->record().fit.mean_percent);
}

TEST(TrainCharacterTest, EveryStepOfRefinementFitsBetter) {
  std::map<std::string, std::shared_ptr<const CharacterModel>> models;
  for (const std::string refine : {"none", "joints", "full"}) {
    TrainOptions options = FastTrainOptions();
    PLEAT_ASSERT_OK_AND_ASSIGN(options.refine, ParseChoice<RigRefinement>("refine", refine));
    PLEAT_ASSERT_OK_AND_ASSIGN(models[refine],
                               TrainCharacter({SmallPerformer().sequence}, options));
  }
  EXPECT_LT(models["joints"]->record().fit.rms_percent, models["none"]->record().fit.rms_percent);
  EXPECT_LT(models["full"]->record().fit.rms_percent,
            0.8 * models["joints"]->record().fit.rms_percent);
  // Only "full" touches weights and rest mesh.
  EXPECT_EQ(models["joints"]->rig().rest_positions, models["none"]->rig().rest_positions);
  EXPECT_EQ(models["joints"]->rig().weights.ToDense(), models["none"]->rig().weights.ToDense());
  EXPECT_NE(models["joints"]->skeleton().RestPositions(),
            models["none"]->skeleton().RestPositions());
  EXPECT_NE(models["full"]->rig().weights.ToDense(), models["none"]->rig().weights.ToDense());
}

TEST(TrainCharacterTest, SeveralClipsShareOneCharacter) {
  PLEAT_ASSERT_OK_AND_ASSIGN(const Performer other,
                             GeneratePerformer({.seed = 5, .num_frames = 30, .num_vertices = 900}));
  PLEAT_ASSERT_OK_AND_ASSIGN(
      const auto model,
      TrainCharacter({SmallPerformer().sequence, other.sequence}, FastTrainOptions()));
  EXPECT_EQ(model->record().num_frames, 90);
  for (const FrameError& error : model->record().worst_frames) {
    EXPECT_TRUE(error.clip == 0 || error.clip == 1);
    EXPECT_LT(error.frame, error.clip == 0 ? 60 : 30);
  }
  EXPECT_LT(model->record().reconstruction.mean_percent, 0.3 * model->record().fit.mean_percent);
}

TEST(TrainCharacterTest, ClipsOfAnotherMeshAreNamed) {
  PLEAT_ASSERT_OK_AND_ASSIGN(
      const Performer other,
      GeneratePerformer({.character_seed = 2, .num_frames = 5, .num_vertices = 900}));
  EXPECT_THAT(TrainCharacter({SmallPerformer().sequence, other.sequence}, FastTrainOptions()),
              HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("first clip")));
}

TEST(TrainCharacterTest, BadOptionsAreRefusedBeforeAnyWork) {
  EXPECT_THAT(TrainCharacter({SmallPerformer().sequence}, {.learner = LearnerChoice{77}}),
              HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("77")));
  EXPECT_THAT(TrainCharacter({SmallPerformer().sequence}, {.rest_frame = 60}),
              HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("rest_frame")));
  EXPECT_THAT(TrainCharacter({}, {}),
              HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("clip")));
}

TEST(TrainCharacterTest, CancelsInEveryStage) {
  for (const double stop_at : {0.0, 0.3, 0.6, 0.9}) {
    std::atomic<double> reached{0};
    const Progress progress([&](const ProgressUpdate& update) { reached = update.fraction; },
                            [&] { return reached >= stop_at; });
    EXPECT_THAT(TrainCharacter({SmallPerformer().sequence}, {}, {}, nullptr, progress),
                HasStatus(absl::StatusCode::kCancelled, HasSubstr("")))
        << "stop at " << stop_at;
  }
}

}  // namespace
}  // namespace pleat
