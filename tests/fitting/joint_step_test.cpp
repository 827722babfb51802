#include "joint_step.h"

#include <gtest/gtest.h>

#include "pleat/base/random.h"
#include "pleat/fitting/moments.h"
#include "pleat/fitting/pose_energy.h"
#include "support/skinned_figure.h"

namespace pleat {
namespace {

class JointStepTest : public testing::Test {
 protected:
  JointStepTest() {
    const SubtreeMoments subtree = ComputeSubtreeMoments(moments_, skeleton());
    for (int t = 0; t < kNumFrames; ++t) {
      const FrameMoments frame = ComputeFrameMoments(figure_.rig, moments_, sequence_.frame(t));
      systems_.push_back(ComputeJointSystem(moments_, subtree, skeleton(), frame,
                                            ToChainPose(skeleton(), track_.pose(t), frame.center)));
    }
    Random random(5);
    displaced_ = skeleton().RestPositions();
    for (int j = 0; j < displaced_.cols(); ++j) {
      if (skeleton().children(j).empty()) continue;
      for (int c = 0; c < 3; ++c) displaced_(c, j) += .03 * random.Normal();
    }
  }
  const Skeleton& skeleton() const { return figure_.rig.skeleton; }

  static constexpr int kNumFrames = 40;
  const SkinnedFigure figure_ = MakeSkinnedFigure({.num_rings = 4, .num_sides = 4});
  const PoseTrack track_ = MakeSmoothPoses(figure_.rig.skeleton, kNumFrames, 6, .6);
  const MeshSequence sequence_ = MakeSkinnedSequence(figure_, track_);
  const RigMoments moments_ = ComputeRigMoments(figure_.rig);
  std::vector<JointSystem> systems_;
  Eigen::Matrix3Xd displaced_;  // joints some centimeters from the truth
};

TEST_F(JointStepTest, SubtreeMomentsAreSumsOverVertices) {
  const SubtreeMoments subtree = ComputeSubtreeMoments(moments_, skeleton());
  Eigen::MatrixXd weights = figure_.rig.weights.ToDense();
  weights.array().colwise() /= weights.rowwise().sum().array().eval();
  Eigen::MatrixXd sums = weights;  // V x J: of a bone and its descendants
  for (int b = skeleton().num_joints() - 1; b >= 1; --b) {
    if (skeleton().parent(b) >= 1) sums.col(skeleton().parent(b)) += sums.col(b);
  }
  const Eigen::Matrix3Xd centered = figure_.rig.rest_positions.colwise() - moments_.center;
  for (int c = 1; c < skeleton().num_joints(); ++c) {
    for (int d = 1; d < skeleton().num_joints(); ++d) {
      EXPECT_NEAR(subtree.products(c, d), sums.col(c).dot(sums.col(d)), 1e-6);
      const Eigen::Vector3d weighted = centered * sums.col(c).cwiseProduct(weights.col(d));
      EXPECT_LT((subtree.weighted[c].col(d) - weighted).norm(), 1e-6);
    }
  }
}

TEST_F(JointStepTest, TheTrueJointsSolveEveryFrame) {
  const Eigen::Matrix3Xd truth = skeleton().RestPositions().colwise() - moments_.center;
  for (const JointSystem& system : systems_) {
    EXPECT_LT((system.matrix - system.matrix.transpose()).cwiseAbs().maxCoeff(), 1e-9);
    const Eigen::VectorXd left = system.matrix * truth.reshaped();
    EXPECT_LT((left - system.right).cwiseAbs().maxCoeff(), 1e-4);
  }
}

// q^T M q - 2 q^T m grows from joints to joints as the measured error of the vertices does, each
// frame at its best translation.
TEST_F(JointStepTest, TheSystemIsTheErrorOfTheVertices) {
  const int t = 9;
  const auto measured = [&](const Eigen::Matrix3Xd& joints) {
    const Skeleton moved = skeleton().WithRestPositions(joints);
    BoneTransforms transforms;
    ComputeBoneTransforms(moved, track_.pose(t), {}, &transforms);
    Eigen::Matrix3Xd positions;
    SkinVertices(figure_.rig.weights, figure_.rig.rest_positions, transforms, &positions);
    const Eigen::Matrix3Xd error = sequence_.FrameAsDouble(t) - positions;
    return (error.colwise() - error.rowwise().mean()).squaredNorm();
  };
  const auto quadratic = [&](const Eigen::Matrix3Xd& joints) {
    const Eigen::VectorXd q = (joints.colwise() - moments_.center).reshaped();
    return q.dot(systems_[t].matrix * q) - 2 * q.dot(systems_[t].right);
  };
  const Eigen::Matrix3Xd truth = skeleton().RestPositions();
  for (const double share : {-1.0, .3, 1.0, 4.0}) {
    const Eigen::Matrix3Xd joints = truth + share * (displaced_ - truth);
    const double expected = measured(joints) - measured(truth);
    EXPECT_NEAR(quadratic(joints) - quadratic(truth), expected, 1e-3 * expected + 1e-6) << share;
  }
}

TEST_F(JointStepTest, DisplacedJointsComeBackWithPosesThatAreKnown) {
  const Eigen::Matrix3Xd solved = SolveJoints(systems_, moments_, skeleton(), displaced_, 1e-7, {});
  for (int j = 0; j < skeleton().num_joints(); ++j) {
    const bool is_leaf = skeleton().children(j).empty();
    if (is_leaf) {
      EXPECT_LT((solved.col(j) - displaced_.col(j)).norm(), 1e-9) << j;
    } else {
      EXPECT_LT((solved.col(j) - skeleton().rest_position(j)).norm(), 2e-3) << j;
    }
  }
}

TEST_F(JointStepTest, AStrongPriorKeepsTheFirstJointsAndAWeakOneTheData) {
  const auto distance = [&](double prior) {
    return (SolveJoints(systems_, moments_, skeleton(), displaced_, prior, {}) - displaced_).norm();
  };
  EXPECT_LT(distance(1e6), 1e-6);
  double last = 0;
  for (const double prior : {1., .1, .01, 1e-4}) {
    EXPECT_GT(distance(prior), last);
    last = distance(prior);
  }
}

TEST_F(JointStepTest, LockedJointsStayExactlyAndTheOthersAreStillSolved) {
  const std::vector<int> locked = {kChest, kLeftLowerLeg};
  const Eigen::Matrix3Xd solved =
      SolveJoints(systems_, moments_, skeleton(), displaced_, 1e-7, locked);
  for (const int j : locked) EXPECT_EQ(solved.col(j), displaced_.col(j));
  EXPECT_LT((solved.col(kRightLowerLeg) - skeleton().rest_position(kRightLowerLeg)).norm(), 6e-3);
}

TEST_F(JointStepTest, MotionThatBendsNothingMovesNoJoint) {
  const PoseTrack still = PoseTrack::FromValid({.poses = {Pose::Rest(skeleton())}});
  const MeshSequence sequence = MakeSkinnedSequence(figure_, still);
  const FrameMoments frame = ComputeFrameMoments(figure_.rig, moments_, sequence.frame(0));
  const JointSystem system =
      ComputeJointSystem(moments_, ComputeSubtreeMoments(moments_, skeleton()), skeleton(), frame,
                         ToChainPose(skeleton(), still.poses()[0], frame.center));
  EXPECT_LT(system.matrix.cwiseAbs().maxCoeff(), 1e-9);
  EXPECT_LT((SolveJoints({system}, moments_, skeleton(), displaced_, 1e-3, {}) - displaced_)
                .cwiseAbs()
                .maxCoeff(),
            1e-6);
}

}  // namespace
}  // namespace pleat
