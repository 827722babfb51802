#include "pleat/character/morph_basis.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pleat/character/pose_evaluator.h"
#include "support/fake_training.h"
#include "support/status_matchers.h"

namespace pleat {
namespace {

using ::testing::HasSubstr;

class MorphBasisTest : public ::testing::Test {
 protected:
  absl::StatusOr<MorphBasis> Basis(const MorphBasisOptions& options) const {
    return ComputeMorphBasis(model_, model_->rig().weights, track_, options);
  }

  // The largest distance and the root mean square of the morphed and skinned frames from those of
  // the model.
  std::pair<double, double> Errors(const MorphBasis& basis, const SkinWeights& weights) const {
    double largest = 0, sum = 0, count = 0;
    PoseEvaluator evaluator(model_);
    EXPECT_THAT(evaluator.EvaluateClip(
                    track_, {},
                    [&](int t, const EvaluatedFrame& frame) {
                      const Eigen::VectorXd folds =
                          (basis.targets * basis.weights.row(t).transpose()).cast<double>();
                      BoneTransforms transforms;
                      ComputeBoneTransforms(model_->skeleton(), track_.pose(t), {}, &transforms);
                      Eigen::Matrix3Xd shown;
                      SkinVertices(
                          weights,
                          model_->rig().rest_positions + folds.reshaped(3, model_->num_vertices()),
                          transforms, &shown);
                      const Eigen::RowVectorXd squared =
                          (shown - frame.positions.cast<double>()).colwise().squaredNorm();
                      largest = std::max(largest, std::sqrt(squared.maxCoeff()));
                      sum += squared.sum();
                      count += static_cast<double>(squared.size());
                      return absl::OkStatus();
                    }),
                IsOk());
    return {largest, std::sqrt(sum / count)};
  }

  const std::shared_ptr<const CharacterModel> model_ = MakeFakeModel(MakeSwayingTube(2), {});
  const PoseTrack track_ = MakeMotion(model_->skeleton(), 30);
};

TEST_F(MorphBasisTest, EnoughTargetsShowTheMeshOfTheModel) {
  PLEAT_ASSERT_OK_AND_ASSIGN(const MorphBasis basis, Basis({.num_targets = 20}));
  EXPECT_LT(Errors(basis, model_->rig().weights).first, 1e-6);
  EXPECT_EQ(basis.weights.rows(), 30);
  EXPECT_EQ(basis.weights.col(0), Eigen::VectorXf::Ones(30));
  for (Eigen::Index k = 1; k < basis.weights.cols(); ++k) {
    EXPECT_EQ(basis.weights.col(k).minCoeff(), 0);
    EXPECT_FLOAT_EQ(basis.weights.col(k).maxCoeff(), 1);
  }
}

TEST_F(MorphBasisTest, TheTableTellsTheErrorsThatTheTargetsHave) {
  PLEAT_ASSERT_OK_AND_ASSIGN(const MorphBasis all, Basis({.num_targets = 9}));
  ASSERT_GE(all.errors.size(), 3u);
  EXPECT_EQ(all.errors[0].num_targets, 0);
  EXPECT_EQ(all.errors[1].num_targets, 1);
  EXPECT_GT(all.errors[0].rms_m, .001);
  double last = 1;
  for (const MorphBasisError& error : all.errors) {
    EXPECT_LE(error.rms_m, last * (1 + 1e-6) + 1e-9);
    last = error.rms_m;
    if (error.num_targets == 0) continue;
    PLEAT_ASSERT_OK_AND_ASSIGN(const MorphBasis some, Basis({.num_targets = error.num_targets}));
    const auto [largest, rms] = Errors(some, model_->rig().weights);
    EXPECT_NEAR(largest, error.max_m, 1e-6) << error.num_targets;
    EXPECT_NEAR(rms, error.rms_m, 1e-6) << error.num_targets;
  }
}

TEST_F(MorphBasisTest, AsManyTargetsAreTakenAsTheErrorAsksFor) {
  PLEAT_ASSERT_OK_AND_ASSIGN(const MorphBasis fine, Basis({.max_error_m = 1e-5}));
  PLEAT_ASSERT_OK_AND_ASSIGN(const MorphBasis coarse, Basis({.max_error_m = .01}));
  EXPECT_LE(Errors(fine, model_->rig().weights).first, 1.1e-5);
  EXPECT_LE(Errors(coarse, model_->rig().weights).first, .01);
  EXPECT_LE(coarse.targets.cols(), fine.targets.cols());
  EXPECT_EQ(fine.errors.back().num_targets, fine.targets.cols());
  EXPECT_THAT(Basis({.max_error_m = 1e-12}),
              HasStatus(absl::StatusCode::kFailedPrecondition, HasSubstr("leave an error")));
}

TEST_F(MorphBasisTest, AFewFramesAreEnoughForTheBasisAndAllHaveWeights) {
  PLEAT_ASSERT_OK_AND_ASSIGN(const MorphBasis basis,
                             Basis({.num_targets = 8, .max_basis_frames = 16}));
  EXPECT_EQ(basis.weights.rows(), 30);
  EXPECT_LT(Errors(basis, model_->rig().weights).second, .001);
}

// The targets also take back what a file with fewer influences loses.
TEST_F(MorphBasisTest, OtherWeightsOfTheFileAreMadeUpFor) {
  std::vector<VertexInfluences> one = model_->rig().weights.influences();
  for (VertexInfluences& vertex : one) vertex = {{vertex.bones[0], 0, 0, 0}, {1, 0, 0, 0}};
  const SkinWeights weights = *SkinWeights::Create(3, one);
  PLEAT_ASSERT_OK_AND_ASSIGN(const MorphBasis basis,
                             ComputeMorphBasis(model_, weights, track_, {.num_targets = 30}));
  EXPECT_LT(Errors(basis, weights).first, 2e-6);
}

TEST_F(MorphBasisTest, WhatCannotBeIsSaid) {
  EXPECT_THAT(Basis({}), HasStatus(kInvalid, HasSubstr("1 to 512")));
  EXPECT_THAT(Basis({.num_targets = 513}), HasStatus(kInvalid, HasSubstr("1 to 512")));
  EXPECT_THAT(ComputeMorphBasis(model_, model_->rig().weights, {}, {.num_targets = 1}),
              HasStatus(kInvalid, HasSubstr("give a motion")));
}

TEST_F(MorphBasisTest, ItStopsWhenItIsCancelled) {
  const Progress cancelled([](const ProgressUpdate&) {}, [] { return true; });
  EXPECT_THAT(
      ComputeMorphBasis(model_, model_->rig().weights, track_, {.num_targets = 2}, cancelled),
      HasStatus(absl::StatusCode::kCancelled, testing::_));
}

}  // namespace
}  // namespace pleat
