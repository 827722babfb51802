#include "prediction_errors.h"

#include <gtest/gtest.h>

#include "pleat/character/pose_evaluator.h"
#include "support/fake_training.h"
#include "support/status_matchers.h"

namespace pleat {
namespace {

// A clip that is exactly what a model predicts for a motion, moved by `offset_m` along x.
class PredictionErrorsTest : public ::testing::Test {
 protected:
  TestSide Side(bool skinned_only, float offset_m, std::vector<int> frames) {
    PoseEvaluator evaluator(model_);
    std::vector<Eigen::Matrix3Xf> positions;
    const auto keep = [&](int, const EvaluatedFrame& frame) {
      positions.push_back(frame.positions.colwise() + Eigen::Vector3f(offset_m, 0, 0));
      return absl::OkStatus();
    };
    const PoseTrack track = MakeMotion(model_->skeleton(), 12);
    EXPECT_THAT(skinned_only ? evaluator.EvaluateSkinnedClip(track, {}, keep)
                             : evaluator.EvaluateClip(track, {}, keep),
                IsOk());
    return {MeshSequence::Create(model_->topology(), std::move(positions), {}).value(), track,
            std::move(frames)};
  }

  const std::shared_ptr<const CharacterModel> model_ = MakeFakeModel(MakeSwayingTube(2), {});
};

TEST_F(PredictionErrorsTest, WhatAModelPredictsHasNoError) {
  for (const bool skinned_only : {false, true}) {
    const TestSide test = Side(skinned_only, 0, {0, 3, 4, 11});
    PLEAT_ASSERT_OK_AND_ASSIGN(const ErrorSummary errors,
                               MeasureModel(model_, test, 2, skinned_only, {}));
    EXPECT_EQ(errors.max_percent, 0);
    EXPECT_EQ(errors.frame_mean_percent.size(), 4u);
    PLEAT_ASSERT_OK_AND_ASSIGN(const ErrorSummary other,
                               MeasureModel(model_, test, 2, !skinned_only, {}));
    EXPECT_GT(other.mean_percent, 0);  // the detail is the difference
  }
}

// Every vertex is one centimeter off: one half of a percent of two meters, and no wrong motion.
TEST_F(PredictionErrorsTest, AShiftIsItsShareOfTheDiagonal) {
  PLEAT_ASSERT_OK_AND_ASSIGN(const ErrorSummary errors,
                             MeasureModel(model_, Side(false, .01f, {2, 3, 4, 8}), 2, false, {}));
  EXPECT_NEAR(errors.mean_percent, .5, 1e-4);
  EXPECT_NEAR(errors.rms_percent, .5, 1e-4);
  EXPECT_NEAR(errors.max_percent, .5, 1e-3);
  EXPECT_NEAR(errors.mean_mm, 10, 1e-3);
  EXPECT_LT(errors.motion_mean_percent, 1e-4);
  EXPECT_EQ(errors.num_motion_frames, 2);  // 3 and 4 have their predecessor among the frames
}

TEST_F(PredictionErrorsTest, ABaselineWithoutDetailIsSkinning) {
  const TestSide test = Side(true, 0, {1, 2, 7});
  const DetailPredictor zero = [this](const Eigen::VectorXd& features) {
    EXPECT_EQ(features.size(), model_->features().num_features());
    return Eigen::VectorXd::Zero(3 * model_->num_vertices()).eval();
  };
  PLEAT_ASSERT_OK_AND_ASSIGN(const ErrorSummary errors,
                             MeasureBaseline(zero, *model_, test, 2, {}));
  EXPECT_LT(errors.max_percent, 1e-4);  // of float32
  // A constant detail of five millimeters, in whatever axes, is that far off everywhere.
  const DetailPredictor constant = [this](const Eigen::VectorXd&) {
    Eigen::VectorXd details = Eigen::VectorXd::Zero(3 * model_->num_vertices());
    for (int v = 0; v < model_->num_vertices(); ++v) details[3 * v + 1] = .005;
    return details;
  };
  PLEAT_ASSERT_OK_AND_ASSIGN(const ErrorSummary off,
                             MeasureBaseline(constant, *model_, test, 2, {}));
  EXPECT_NEAR(off.mean_mm, 5, 1e-3);
  EXPECT_NEAR(off.max_percent, .25, 1e-4);
}

TEST_F(PredictionErrorsTest, CancellationIsHeard) {
  EXPECT_TRUE(absl::IsCancelled(
      MeasureModel(model_, Side(false, 0, {1, 2}), 2, false, Progress({}, [] { return true; }))
          .status()));
}

}  // namespace
}  // namespace pleat
