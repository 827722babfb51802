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
    EXPECT_LE((dense.row(v).array() > 0).count(), kStandardInfluences);
  }
}

TEST_F(VertexStepTest, AVertexHasAsManyBonesAsItMay) {
  const Rig rigid = Rigid();
  for (const int most : {1, 2, 8}) {
    PLEAT_ASSERT_OK_AND_ASSIGN(
        const SkinWeights refined,
        RefineWeights(moments_, rigid, rigid.weights, adjacency_,
                      {.prior = 1e-6, .max_influences = most, .num_threads = 1}, {}));
    EXPECT_LE(refined.most_influences(), most);
    if (most == 8) {
      EXPECT_GT(refined.most_influences(), 4);
    }
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

// Sum over all edges of the squared difference of what lies at their ends (rows).
double Roughness(const Eigen::MatrixXd& rows, const VertexAdjacency& adjacency) {
  double sum = 0;
  for (int v = 0; v < rows.rows(); ++v) {
    for (const int32_t n : adjacency.neighbors(v)) sum += (rows.row(v) - rows.row(n)).squaredNorm();
  }
  return sum;
}

TEST_F(VertexStepTest, SmoothnessEvensOutBetweenNeighbors) {
  const Rig rigid = Rigid();
  Rig moved = figure_.rig;
  Random random(3);
  for (double& x : moved.rest_positions.reshaped()) x += .01 * random.Normal();
  double last_weights = 1e9, last_rest = 1e9;
  for (const double smoothness : {0.0, .01, .1}) {
    PLEAT_ASSERT_OK_AND_ASSIGN(const SkinWeights weights,
                               RefineWeights(moments_, rigid, rigid.weights, adjacency_,
                                             {.smoothness = smoothness, .num_threads = 1}, {}));
    EXPECT_LT(Roughness(weights.ToDense(), adjacency_), last_weights) << smoothness;
    last_weights = Roughness(weights.ToDense(), adjacency_);
    PLEAT_ASSERT_OK_AND_ASSIGN(
        const Eigen::Matrix3Xd rest,
        RefineRestPositions(moments_, moved, moved.rest_positions, adjacency_,
                            {.smoothness = smoothness, .num_threads = 1}, {}));
    const Eigen::MatrixXd displacements = (rest - moved.rest_positions).transpose();
    EXPECT_LT(Roughness(displacements, adjacency_), last_rest) << smoothness;
    last_rest = Roughness(displacements, adjacency_);
  }
}

// A vertex may take bones of its own, of its neighbors, and those next to its own in the skeleton.
TEST_F(VertexStepTest, WeightsStayNearTheirBones) {
  const Rig rigid = Rigid();
  const Eigen::MatrixXd before = rigid.weights.ToDense();
  const Skeleton& skeleton = figure_.rig.skeleton;
  PLEAT_ASSERT_OK_AND_ASSIGN(
      const SkinWeights refined,
      RefineWeights(moments_, rigid, rigid.weights, adjacency_, {.num_sweeps = 1}, {}));
  const Eigen::MatrixXd after = refined.ToDense();
  EXPECT_EQ(after.col(0).cwiseAbs().maxCoeff(), 0);  // the root has no bone
  for (int v = 0; v < after.rows(); ++v) {
    Eigen::Index own = 0;
    before.row(v).maxCoeff(&own);
    for (int b = 1; b < skeleton.num_joints(); ++b) {
      if (after(v, b) == 0) continue;
      const int parent = skeleton.parent(static_cast<int>(own));
      const bool is_near =
          b == own || b == parent || skeleton.parent(b) == own || skeleton.parent(b) == parent;
      bool is_neighbors = false;
      for (const int32_t n : adjacency_.neighbors(v)) is_neighbors |= before(n, b) > 0;
      EXPECT_TRUE(is_near || is_neighbors) << "vertex " << v << " of bone " << own << " took " << b;
    }
  }
}

TEST_F(VertexStepTest, ThreadsDoNotChangeTheResult) {
  const Rig rigid = Rigid();
  const WeightStepOptions one{.smoothness = .01, .prior = .001, .num_threads = 1};
  WeightStepOptions three = one;
  three.num_threads = 3;
  EXPECT_EQ(RefineWeights(moments_, rigid, rigid.weights, adjacency_, one, {})->ToDense(),
            RefineWeights(moments_, rigid, rigid.weights, adjacency_, three, {})->ToDense());
  const auto rest = [&](int num_threads) {
    return RefineRestPositions(moments_, rigid, rigid.rest_positions, adjacency_,
                               {.smoothness = 1, .prior = .1, .num_threads = num_threads}, {})
        .value();
  };
  EXPECT_EQ(rest(1), rest(3));
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
  EXPECT_THAT(RefineRestPositions(moments_, figure_.rig, figure_.rig.rest_positions, adjacency_, {},
                                  cancelled),
              HasStatus(absl::StatusCode::kCancelled, testing::_));
}

}  // namespace
}  // namespace pleat
