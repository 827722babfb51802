#include "pleat/character/evaluate.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pleat/base/random.h"
#include "support/status_matchers.h"
#include "trained_performer.h"

namespace pleat {
namespace {

using ::testing::HasSubstr;
using ::testing::Key;
using ::testing::UnorderedElementsAre;

TEST(EvaluateTest, HeldOutFramesAreBetterThanSkinningAndTheMean) {
  PLEAT_ASSERT_OK_AND_ASSIGN(const EvaluateReport report,
                             EvaluateCharacter(SmallPerformer().sequence, std::nullopt,
                                               FastEvaluateOptions(EvaluationProtocol::kEvery5th)));
  EXPECT_EQ(report.num_test_frames, 12);
  EXPECT_EQ(report.num_train_frames, 48);
  EXPECT_LT(report.hybrid.mean_percent, 0.5 * report.skinned.mean_percent);
  EXPECT_LT(report.hybrid.mean_percent, report.baselines.at("mean").mean_percent);
  EXPECT_THAT(report.baselines,
              UnorderedElementsAre(Key("zero"), Key("mean"), Key("nearest"), Key("ridge")));
  EXPECT_THAT(report.learners, UnorderedElementsAre(Key("gp"), Key("sgplvm"), Key("regional")));
  EXPECT_EQ(report.hybrid.mean_percent, report.learners.at("gp").mean_percent);
  EXPECT_NEAR(report.baselines.at("zero").mean_percent, report.skinned.mean_percent, 1e-4);
  EXPECT_EQ(report.hybrid.frame_mean_percent.size(), 12u);
}

TEST(EvaluateTest, ReconstructionIsNearZeroForEveryLearner) {
  PLEAT_ASSERT_OK_AND_ASSIGN(
      const EvaluateReport report,
      EvaluateCharacter(SmallPerformer().sequence, std::nullopt,
                        FastEvaluateOptions(EvaluationProtocol::kReconstruct)));
  for (const auto& [name, errors] : report.learners) {
    EXPECT_LT(errors.mean_percent, 0.15 * report.skinned.mean_percent) << name;
  }
  EXPECT_LT(report.baselines.at("nearest").mean_percent, 1e-3);
}

TEST(EvaluateTest, NothingThatIsLearnedSeesTheTestFrames) {
  // Shifting the test meshes as a whole moves their poses, not the details: were anything learned
  // from test frames, rig or mean detail or learner would change with them.
  const MeshSequence& sequence = SmallPerformer().sequence;
  PLEAT_ASSERT_OK_AND_ASSIGN(const FrameSplit split,
                             SplitFrames(EvaluationProtocol::kLast30, sequence.num_frames()));
  std::vector<Eigen::Matrix3Xf> frames;
  for (int t = 0; t < sequence.num_frames(); ++t) frames.push_back(sequence.frame(t));
  for (const int t : split.test) frames[t].colwise() += Eigen::Vector3f(0.5f, 0, 0.25f);
  PLEAT_ASSERT_OK_AND_ASSIGN(const MeshSequence shifted,
                             MeshSequence::Create(sequence.topology(), std::move(frames)));
  const EvaluateOptions options = FastEvaluateOptions(EvaluationProtocol::kLast30);
  PLEAT_ASSERT_OK_AND_ASSIGN(const EvaluateReport plain,
                             EvaluateCharacter(sequence, std::nullopt, options));
  PLEAT_ASSERT_OK_AND_ASSIGN(const EvaluateReport moved,
                             EvaluateCharacter(shifted, std::nullopt, options));
  EXPECT_NEAR(moved.skinned.mean_percent, plain.skinned.mean_percent, 1e-3);
  EXPECT_NEAR(moved.hybrid.mean_percent, plain.hybrid.mean_percent, 1e-2);
  EXPECT_NEAR(moved.baselines.at("mean").mean_percent, plain.baselines.at("mean").mean_percent,
              1e-3);
}

TEST(EvaluateTest, NeitherTrainingNorSelectionSeesTestFrames) {
  // With the test meshes crumpled, rig, poses, details and learners must stay the same to the bit,
  // and so must the errors on the training frames that were held out to choose the learner.
  const MeshSequence& sequence = SmallPerformer().sequence;
  for (const EvaluationProtocol protocol :
       {EvaluationProtocol::kEvery5th, EvaluationProtocol::kBlocks10,
        EvaluationProtocol::kLast30}) {
    PLEAT_ASSERT_OK_AND_ASSIGN(const FrameSplit split,
                               SplitFrames(protocol, sequence.num_frames()));
    std::vector<Eigen::Matrix3Xf> frames;
    for (int t = 0; t < sequence.num_frames(); ++t) frames.push_back(sequence.frame(t));
    Random random(3);
    for (const int t : split.test) {
      for (float& x : frames[t].reshaped()) x += static_cast<float>(random.Uniform(-.1, .1));
    }
    PLEAT_ASSERT_OK_AND_ASSIGN(const MeshSequence crumpled,
                               MeshSequence::Create(sequence.topology(), std::move(frames)));
    EvaluateOptions options = FastEvaluateOptions(protocol);
    options.train.learner = LearnerChoice::kAuto;
    options.train.iterations = 20;
    options.learners.clear();
    options.measure_baselines = false;
    PLEAT_ASSERT_OK_AND_ASSIGN(const EvaluateReport plain,
                               EvaluateCharacter(sequence, std::nullopt, options));
    PLEAT_ASSERT_OK_AND_ASSIGN(const EvaluateReport other,
                               EvaluateCharacter(crumpled, std::nullopt, options));
    EXPECT_GT(plain.validation.num_held_out_frames, 5);
    EXPECT_EQ(plain.validation.mean_percent, other.validation.mean_percent);
    EXPECT_EQ(plain.learner, other.learner);
    EXPECT_GT(other.hybrid.mean_percent, 2 * plain.hybrid.mean_percent);  // they were tested
  }
}

TEST(EvaluateTest, CrossNeedsASecondClipOfTheSameMesh) {
  EXPECT_THAT(EvaluateCharacter(SmallPerformer().sequence, std::nullopt,
                                FastEvaluateOptions(EvaluationProtocol::kCross)),
              HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("second clip")));
  PLEAT_ASSERT_OK_AND_ASSIGN(
      const Performer other,
      GeneratePerformer({.character_seed = 2, .num_frames = 5, .num_vertices = 900}));
  EXPECT_THAT(EvaluateCharacter(SmallPerformer().sequence, other.sequence,
                                FastEvaluateOptions(EvaluationProtocol::kCross)),
              HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("connectivity")));
}

TEST(EvaluateTest, SeveralClipsTeachMoreThanOne) {
  PLEAT_ASSERT_OK_AND_ASSIGN(const Performer more,
                             GeneratePerformer({.seed = 5, .num_frames = 60, .num_vertices = 900}));
  PLEAT_ASSERT_OK_AND_ASSIGN(const Performer test,
                             GeneratePerformer({.seed = 9, .num_frames = 25, .num_vertices = 900}));
  EvaluateOptions options = FastEvaluateOptions(EvaluationProtocol::kCross);
  PLEAT_ASSERT_OK_AND_ASSIGN(const EvaluateReport one,
                             EvaluateCharacter(SmallPerformer().sequence, test.sequence, options));
  options.more_training_clips = {more.sequence};
  PLEAT_ASSERT_OK_AND_ASSIGN(const EvaluateReport two,
                             EvaluateCharacter(SmallPerformer().sequence, test.sequence, options));
  EXPECT_EQ(two.num_train_frames, 120);
  EXPECT_EQ(two.num_test_frames, 25);
  EXPECT_LT(two.hybrid.mean_percent, one.hybrid.mean_percent);
  options.protocol = EvaluationProtocol::kBlocks10;
  EXPECT_THAT(EvaluateCharacter(SmallPerformer().sequence, std::nullopt, options),
              HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("protocol cross")));
}

TEST(EvaluateTest, CrossTestsEveryFrameOfTheSecondClip) {
  PLEAT_ASSERT_OK_AND_ASSIGN(const Performer other,
                             GeneratePerformer({.seed = 9, .num_frames = 25, .num_vertices = 900}));
  // With the first rig; so little is left by a refined one that 60 frames of another motion do not
  // teach it.
  EvaluateOptions options = FastEvaluateOptions(EvaluationProtocol::kCross);
  options.train.refine = RigRefinement::kNone;
  PLEAT_ASSERT_OK_AND_ASSIGN(const EvaluateReport report,
                             EvaluateCharacter(SmallPerformer().sequence, other.sequence, options));
  EXPECT_EQ(report.num_test_frames, 25);
  EXPECT_LT(report.hybrid.mean_percent, report.skinned.mean_percent);
}

}  // namespace
}  // namespace pleat
