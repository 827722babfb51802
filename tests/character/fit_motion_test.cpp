#include "pleat/character/fit_motion.h"

#include <gtest/gtest.h>

#include "pleat/character/pose_evaluator.h"
#include "support/fake_training.h"
#include "support/status_matchers.h"

namespace pleat {
namespace {

class FitMotionTest : public testing::Test {
 protected:
  // The model's rig alone, moved by a motion that is known.
  MeshSequence SkinnedSequence(const PoseTrack& track) const {
    PoseEvaluator evaluator(model_);
    EvaluatedFrame frame;
    std::vector<Eigen::Matrix3Xf> frames;
    for (int t = 0; t < track.num_frames(); ++t) {
      EXPECT_THAT(evaluator.EvaluateSkinned(track.pose(t), {}, &frame), IsOk());
      frames.push_back(frame.positions);
    }
    return MeshSequence::Create(model_->topology(), std::move(frames),
                                {.name = "motion", .frame_rate = {25, 1}})
        .value();
  }

  const MeshSequence clip_ = MakeSwayingTube(4);
  const std::shared_ptr<const CharacterModel> model_ = MakeFakeModel(clip_, TrainOptions());
};

TEST_F(FitMotionTest, TheMotionThatMovedAMeshIsFoundAgain) {
  const MeshSequence sequence = SkinnedSequence(MakeMotion(model_->skeleton(), 12));
  PLEAT_ASSERT_OK_AND_ASSIGN(const PoseTrack fitted, FitMotion(*model_, sequence));
  ASSERT_EQ(fitted.num_frames(), 12);
  EXPECT_EQ(fitted.fps(), 25);
  const MeshSequence again = SkinnedSequence(fitted);
  for (int t = 0; t < 12; ++t) {
    const float error = (again.frame(t) - sequence.frame(t)).colwise().norm().mean();
    EXPECT_LT(error, 5e-3f) << t;  // of 1.6 m: stiffness and smoothness cost a little
  }
}

TEST_F(FitMotionTest, ThreadsDoNotChangeThePoses) {
  const MeshSequence sequence = SkinnedSequence(MakeMotion(model_->skeleton(), 6));
  const PoseTrack one = FitMotion(*model_, sequence, {.num_threads = 1}).value();
  const PoseTrack three = FitMotion(*model_, sequence, {.num_threads = 3}).value();
  for (int t = 0; t < 6; ++t) {
    EXPECT_EQ(one.pose(t).root_position, three.pose(t).root_position);
    for (size_t j = 0; j < one.pose(t).rotations.size(); ++j) {
      EXPECT_EQ(one.pose(t).rotations[j].coeffs(), three.pose(t).rotations[j].coeffs());
    }
  }
}

TEST_F(FitMotionTest, AnotherConnectivityIsRefusedWithBothMeshes) {
  EXPECT_THAT(FitMotion(*model_, MakeSwayingTube(2, "other", 5, 4)),
              HasStatus(absl::StatusCode::kInvalidArgument,
                        "'other' has 20 vertices and 16 faces, the model 96 and 88: poses are "
                        "found only in a mesh with the model's own connectivity"));
}

TEST_F(FitMotionTest, CancellationIsHeard) {
  EXPECT_THAT(FitMotion(*model_, clip_, {}, Progress(nullptr, [] { return true; })),
              HasStatus(absl::StatusCode::kCancelled, testing::_));
}

}  // namespace
}  // namespace pleat
