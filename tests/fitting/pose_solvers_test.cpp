#include "pleat/fitting/pose_solvers.h"

#include <gtest/gtest.h>

#include "support/skinned_figure.h"

namespace pleat {
namespace {

class PoseSolversTest : public ::testing::Test {
 protected:
  PoseSolversTest()
      : figure_(MakeSkinnedFigure()),
        skeleton_(figure_.rig.skeleton),
        track_(MakeSmoothPoses(skeleton_, 40, 11)),
        sequence_(MakeSkinnedSequence(figure_, track_)),
        moments_(ComputeRigMoments(figure_.rig)),
        chain_(ComputeChainMoments(moments_, skeleton_)),
        energy_(chain_, skeleton_, 0) {}

  FrameMoments SetFrame(int t) {
    const FrameMoments frame = ComputeFrameMoments(figure_.rig, moments_, sequence_.frame(t));
    energy_.SetFrame(ComputeChainCross(moments_, frame, skeleton_), frame.sum_squares);
    return frame;
  }
  double Rms(const ChainPose& pose) const {
    return std::sqrt(std::max(0.0, energy_.DataValue(pose)) / sequence_.num_vertices());
  }

  SkinnedFigure figure_;
  const Skeleton& skeleton_;
  PoseTrack track_;
  MeshSequence sequence_;
  RigMoments moments_;
  ChainMoments chain_;
  PoseEnergy energy_;
};

TEST_F(PoseSolversTest, ClosedFormWalkIsExactForARigidlyMovedBody) {
  Pose rigid = Pose::Rest(skeleton_);
  rigid.root_position += Eigen::Vector3d(1, -2, 3);
  rigid.rotations[0] = QuaternionFromExponentialMap({0.5, 2.5, -0.4});
  sequence_ = MakeSkinnedSequence(figure_, PoseTrack::FromValid({.poses = {rigid}}));
  const FrameMoments frame = SetFrame(0);
  EXPECT_LT(Rms(ClosedFormWalk(moments_, frame, skeleton_)), 1e-5);
}

TEST_F(PoseSolversTest, ClosedFormWalkIsAGoodStartForAnyFrame) {
  for (int t = 0; t < 40; t += 5) {
    const FrameMoments frame = SetFrame(t);
    EXPECT_LT(Rms(ClosedFormWalk(moments_, frame, skeleton_)), 0.03) << "frame " << t;
  }
}

TEST_F(PoseSolversTest, WalkSweepNeverRaisesTheEnergyAndConverges) {
  const FrameMoments frame = SetFrame(30);
  ChainPose pose = ToChainPose(skeleton_, Pose::Rest(skeleton_), frame.center);
  double before = energy_.Value(pose);
  const double start = before;
  for (int sweep = 0; sweep < 30; ++sweep) {
    WalkSweep(energy_, skeleton_, &pose);
    const double after = energy_.Value(pose);
    EXPECT_LE(after, before + 1e-9);
    before = after;
  }
  EXPECT_LT(before, 0.01 * start);
}

TEST_F(PoseSolversTest, AllJointsRecoverTheTruth) {
  for (int t = 0; t < 40; t += 3) {
    const FrameMoments frame = SetFrame(t);
    ChainPose pose = ClosedFormWalk(moments_, frame, skeleton_);
    const PoseSolverSummary summary = MinimizePose(energy_, {}, &pose);
    EXPECT_TRUE(summary.converged);
    EXPECT_LT(Rms(pose), 1e-5) << "frame " << t;
    const ChainPose truth = ToChainPose(skeleton_, track_.pose(t), frame.center);
    EXPECT_LT((pose.root_position - truth.root_position).norm(), 1e-4);
    for (int b = 1; b < skeleton_.num_joints(); ++b) {
      EXPECT_LT((pose.rotation(b) - truth.rotation(b)).norm(), 1e-3) << "bone " << b;
      EXPECT_LT(
          (pose.rotation(b) * pose.rotation(b).transpose() - Eigen::Matrix3d::Identity()).norm(),
          1e-12);
    }
  }
}

// Starts that are as wrong as can be: any rotation of any bone.
TEST_F(PoseSolversTest, NoStartIsMadeWorse) {
  Random random(15);
  for (int t = 0; t < 40; t += 8) {
    const FrameMoments frame = SetFrame(t);
    ChainPose start = ToChainPose(skeleton_, Pose::Rest(skeleton_), frame.center);
    Eigen::VectorXd move(3 * start.num_joints() + 3);
    for (double& entry : move) entry = 3 * random.Normal();
    start.Move(move);
    double last = energy_.Value(start);
    for (const int max_iterations : {1, 2, 5, 20, 200}) {
      ChainPose pose = start;
      const PoseSolverSummary summary =
          MinimizePose(energy_, {.max_iterations = max_iterations}, &pose);
      EXPECT_LE(summary.num_iterations, max_iterations);
      EXPECT_LE(summary.energy, last * (1 + 1e-12)) << max_iterations;
      EXPECT_NEAR(summary.energy, energy_.Value(pose), 1e-9 * last);
      last = summary.energy;
    }
    ChainPose walked = start;
    WalkSweep(energy_, skeleton_, &walked);
    EXPECT_LE(energy_.Value(walked), energy_.Value(start));
  }
}

TEST_F(PoseSolversTest, ZeroIterationsLeaveTheStart) {
  const FrameMoments frame = SetFrame(9);
  ChainPose pose = ClosedFormWalk(moments_, frame, skeleton_);
  const Eigen::Matrix3Xd start = pose.rotations;
  const PoseSolverSummary summary = MinimizePose(energy_, {.max_iterations = 0}, &pose);
  EXPECT_FALSE(summary.converged);
  EXPECT_EQ(pose.rotations, start);
}

TEST_F(PoseSolversTest, ABoneWithoutVerticesFollowsItsParent) {
  // The head's tube is given to the chest: nothing determines the head's rotation.
  Eigen::MatrixXd dense = figure_.rig.weights.ToDense();
  dense.col(kChest) += dense.col(kHead);
  dense.col(kHead).setZero();
  figure_.rig.weights = *SkinWeights::FromDense(dense);
  sequence_ = MakeSkinnedSequence(figure_, track_);
  moments_ = ComputeRigMoments(figure_.rig);
  chain_ = ComputeChainMoments(moments_, skeleton_);
  PoseEnergy energy(chain_, skeleton_, 1e-7 * chain_.gram.trace());
  const FrameMoments frame = SetFrame(12);
  energy.SetFrame(ComputeChainCross(moments_, frame, skeleton_), frame.sum_squares);
  ChainPose pose = ClosedFormWalk(moments_, frame, skeleton_);
  EXPECT_LT((pose.rotation(kHead) - pose.rotation(kChest)).norm(), 1e-6);
  MinimizePose(energy, {}, &pose);
  EXPECT_LT((pose.rotation(kHead) - pose.rotation(kChest)).norm(), 1e-2);
  EXPECT_TRUE(pose.rotations.allFinite());
}

}  // namespace
}  // namespace pleat
