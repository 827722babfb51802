#include "vertex_step.h"

#include <gtest/gtest.h>

#include "pleat/base/random.h"
#include "pleat/fitting/pose_energy.h"
#include "support/skinned_figure.h"
#include "support/status_matchers.h"

namespace pleat {
namespace {

class VertexStepTest : public testing::Test {
 protected:
  VertexStepTest() {
    for (int t = 0; t < kNumFrames; ++t) {
      frames_.push_back(t);
      centers_.push_back(sequence_.FrameAsDouble(t).rowwise().mean());
      poses_.push_back(ToChainPose(figure_.rig.skeleton, track_.poses()[t], centers_.back()));
    }
    moments_ =
        ComputeVertexMoments(sequence_, frames_, poses_, centers_, figure_.rig, 1, {}).value();
  }
  // The true rig with other weights: every vertex follows its own bone alone.
  Rig Rigid() const {
    Rig rig = figure_.rig;
    Eigen::MatrixXd dense = rig.weights.ToDense();
    for (int v = 0; v < dense.rows(); ++v) {
      Eigen::Index strongest = 0;
      dense.row(v).maxCoeff(&strongest);
      dense.row(v).setZero();
      dense(v, strongest) = 1;
    }
    rig.weights = SkinWeights::FromDense(dense).value();
    return rig;
  }
  double WeightError(const SkinWeights& weights) const {
    return (weights.ToDense() - figure_.rig.weights.ToDense()).cwiseAbs().rowwise().sum().mean();
  }

  static constexpr int kNumFrames = 40;
  const SkinnedFigure figure_ = MakeSkinnedFigure({.num_rings = 4, .num_sides = 4});
  const PoseTrack track_ = MakeSmoothPoses(figure_.rig.skeleton, kNumFrames, 6, .6);
  const MeshSequence sequence_ = MakeSkinnedSequence(figure_, track_);
  const VertexAdjacency adjacency_{figure_.topology};
  std::vector<int> frames_;
  std::vector<ChainPose> poses_;
  std::vector<Eigen::Vector3d> centers_;
  VertexMoments moments_;
};

TEST_F(VertexStepTest, WeightsThatAreRightStay) {
  PLEAT_ASSERT_OK_AND_ASSIGN(const SkinWeights refined,
                             RefineWeights(moments_, figure_.rig, figure_.rig.weights, adjacency_,
                                           {.num_threads = 1}, {}));
  EXPECT_LT(WeightError(refined), .02);
}

TEST_F(VertexStepTest, WeightsOfOneBoneBecomeTheTrueBlends) {
  const Rig rigid = Rigid();
  ASSERT_GT(WeightError(rigid.weights), .2);
  PLEAT_ASSERT_OK_AND_ASSIGN(
      const SkinWeights refined,
      RefineWeights(moments_, rigid, rigid.weights, adjacency_, {.num_threads = 1}, {}));
  EXPECT_LT(WeightError(refined), .1 * WeightError(rigid.weights));
  const Eigen::MatrixXd dense = refined.ToDense();
  for (int v = 0; v < dense.rows(); ++v) {
    EXPECT_NEAR(dense.row(v).sum(), 1, 1e-5);
    EXPECT_GE(dense.row(v).minCoeff(), 0);
    EXPECT_LE((dense.row(v).array() > 0).count(), kMaxInfluences);
  }
}

TEST_F(VertexStepTest, AStrongPriorKeepsTheFirstWeights) {
  const Rig rigid = Rigid();
  PLEAT_ASSERT_OK_AND_ASSIGN(const SkinWeights refined,
                             RefineWeights(moments_, rigid, rigid.weights, adjacency_,
                                           {.prior = 1e6, .num_threads = 1}, {}));
  EXPECT_LT((refined.ToDense() - rigid.weights.ToDense()).cwiseAbs().maxCoeff(), 1e-3);
}

TEST_F(VertexStepTest, RestPositionsThatWereMovedComeBack) {
  Rig moved = figure_.rig;
  Random random(3);
  for (double& x : moved.rest_positions.reshaped()) x += .01 * random.Normal();
  PLEAT_ASSERT_OK_AND_ASSIGN(const Eigen::Matrix3Xd refined,
                             RefineRestPositions(moments_, moved, moved.rest_positions, adjacency_,
                                                 {.num_threads = 1}, {}));
  // The center of the moments is that of the true rig, so the truth is found up to rounding.
  EXPECT_LT((refined - figure_.rig.rest_positions).colwise().norm().maxCoeff(), 1e-4);
  PLEAT_ASSERT_OK_AND_ASSIGN(const Eigen::Matrix3Xd kept,
                             RefineRestPositions(moments_, moved, moved.rest_positions, adjacency_,
                                                 {.prior = 1e9, .num_threads = 1}, {}));
  EXPECT_LT((kept - moved.rest_positions).cwiseAbs().maxCoeff(), 1e-6);
}

TEST_F(VertexStepTest, ThreadsDoNotChangeTheResult) {
  const Rig rigid = Rigid();
  const WeightStepOptions one{.smoothness = .01, .prior = .001, .num_threads = 1};
  WeightStepOptions three = one;
  three.num_threads = 3;
  EXPECT_EQ(RefineWeights(moments_, rigid, rigid.weights, adjacency_, one, {})->ToDense(),
            RefineWeights(moments_, rigid, rigid.weights, adjacency_, three, {})->ToDense());
  const VertexMoments again =
      ComputeVertexMoments(sequence_, frames_, poses_, centers_, figure_.rig, 3, {}).value();
  EXPECT_EQ(again.pairs, moments_.pairs);
  EXPECT_EQ(again.cross, moments_.cross);
}

TEST_F(VertexStepTest, CancellationIsHeard) {
  const Progress cancelled(nullptr, [] { return true; });
  EXPECT_THAT(ComputeVertexMoments(sequence_, frames_, poses_, centers_, figure_.rig, 1, cancelled),
              HasStatus(absl::StatusCode::kCancelled, testing::_));
  EXPECT_THAT(RefineWeights(moments_, figure_.rig, figure_.rig.weights, adjacency_, {}, cancelled),
              HasStatus(absl::StatusCode::kCancelled, testing::_));
}

}  // namespace
}  // namespace pleat
