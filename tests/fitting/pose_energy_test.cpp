#include "pleat/fitting/pose_energy.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "pleat/math/rotations.h"
#include "pleat/optimize/objective.h"
#include "support/skinned_figure.h"

namespace pleat {
namespace {

// The energy along tangent vectors at `base`.
class TangentObjective : public Objective {
 public:
  TangentObjective(const PoseEnergy& energy, const ChainPose& base)
      : energy_(energy), base_(base) {}
  int num_unknowns() const override { return 3 * base_.num_joints() + 3; }
  double Evaluate(const Eigen::VectorXd& x, Eigen::VectorXd* gradient) override {
    ChainPose pose = base_;
    pose.Move(x);
    if (gradient == nullptr) return energy_.Value(pose);
    Eigen::MatrixXd hessian;
    return energy_.Linearize(pose, gradient, &hessian);
  }

 private:
  const PoseEnergy& energy_;
  const ChainPose& base_;
};

class PoseEnergyTest : public ::testing::Test {
 protected:
  PoseEnergyTest()
      : figure_(MakeSkinnedFigure()),
        track_(MakeSmoothPoses(figure_.rig.skeleton, 8, 5)),
        sequence_(MakeSkinnedSequence(figure_, track_)),
        moments_(ComputeRigMoments(figure_.rig)),
        chain_(ComputeChainMoments(moments_, figure_.rig.skeleton)) {}

  // An energy with every term, and a pose away from its minimum.
  PoseEnergy MakeEnergy(int t, double bend, double attraction) {
    PoseEnergy energy(chain_, figure_.rig.skeleton, bend);
    const FrameMoments frame = ComputeFrameMoments(figure_.rig, moments_, sequence_.frame(t));
    energy.SetFrame(ComputeChainCross(moments_, frame, figure_.rig.skeleton), frame.sum_squares);
    if (attraction > 0) energy.AddAttraction(PoseAt(2).rotations, attraction);
    return energy;
  }
  ChainPose PoseAt(int t) const {
    return ToChainPose(figure_.rig.skeleton, track_.pose(t), {0.3, 0.8, 0.4});
  }

  SkinnedFigure figure_;
  PoseTrack track_;
  MeshSequence sequence_;
  RigMoments moments_;
  ChainMoments chain_;
};

TEST_F(PoseEnergyTest, GradientAgreesWithDifferences) {
  for (const double attraction : {0.0, 0.7}) {
    const PoseEnergy energy = MakeEnergy(7, 0.5, attraction);
    const ChainPose base = PoseAt(0);
    TangentObjective objective(energy, base);
    const GradientCheck check =
        CheckGradient(objective, Eigen::VectorXd::Zero(objective.num_unknowns()));
    EXPECT_LT(check.max_relative_error, 1e-6) << "unknown " << check.worst_unknown;
  }
}

TEST_F(PoseEnergyTest, GaussNewtonMatrixIsTheCurvatureOfTheLinearizedVertices) {
  // E of vertices moved linearly along a tangent d is E + g.d + d.H.d / 2 exactly, so H is checked
  // through the Jacobian: |J d|^2 = d.H.d / 2, with J d by central differences of the vertices.
  const PoseEnergy energy = MakeEnergy(7, 0, 0);
  const ChainPose base = PoseAt(3);
  Eigen::VectorXd gradient;
  Eigen::MatrixXd hessian;
  energy.Linearize(base, &gradient, &hessian);
  EXPECT_LT((hessian - hessian.transpose()).cwiseAbs().maxCoeff(), 1e-9);
  auto vertices = [&](const Eigen::VectorXd& step) {
    ChainPose pose = base;
    pose.Move(step);
    const Pose local = FromChainPose(figure_.rig.skeleton, pose, Eigen::Vector3d::Zero());
    BoneTransforms transforms;
    ComputeBoneTransforms(figure_.rig.skeleton, local, {}, &transforms);
    Eigen::Matrix3Xd positions;
    SkinVertices(figure_.rig.weights, figure_.rig.rest_positions, transforms, &positions);
    return positions;
  };
  Random random(4);
  for (int trial = 0; trial < 5; ++trial) {
    Eigen::VectorXd direction(gradient.size());
    for (double& entry : direction) entry = random.Normal();
    const double h = 1e-5;
    const Eigen::Matrix3Xd derivative =
        (vertices(h * direction) - vertices(-h * direction)) / (2 * h);
    const double expected = 2 * derivative.squaredNorm();
    EXPECT_NEAR(direction.dot(hessian * direction), expected, 1e-5 * expected);
  }
}

TEST_F(PoseEnergyTest, StiffnessTermsAreWhatTheySay) {
  // Joints without human names: all bones bend alike.
  std::vector<Joint> joints = figure_.rig.skeleton.joints();
  for (size_t j = 0; j < joints.size(); ++j) joints[j].name = "joint" + std::to_string(j);
  figure_.rig.skeleton = *Skeleton::Create(joints);
  const ChainPose pose = PoseAt(5), target = PoseAt(2);
  const double data = MakeEnergy(1, 0, 0).Value(pose);
  double bend = 0, attraction = 0;
  for (int a = 0; a < pose.num_joints(); ++a) {
    attraction += (pose.rotation(a) - target.rotation(a)).squaredNorm();
    if (a == 0) continue;
    const int parent = figure_.rig.skeleton.parent(a);
    bend += (pose.rotation(a) - pose.rotation(parent)).squaredNorm();
  }
  EXPECT_NEAR(MakeEnergy(1, 0.5, 0.7).Value(pose), data + 0.5 * bend + 0.7 * attraction, 1e-9);
  EXPECT_NEAR(MakeEnergy(1, 0.5, 0.7).DataValue(pose), data, 1e-9);
}

TEST_F(PoseEnergyTest, ThePelvisIsStiffer) {
  const ChainPose rest =
      ToChainPose(figure_.rig.skeleton, Pose::Rest(figure_.rig.skeleton), Eigen::Vector3d::Zero());
  auto cost_of_turning = [&](int bone) {
    ChainPose pose = rest;
    pose.rotation(bone) = QuaternionFromExponentialMap({0, 0.2, 0}).toRotationMatrix();
    const PoseEnergy energy = MakeEnergy(1, 0.5, 0);
    return energy.Value(pose) - energy.DataValue(pose);
  };
  // The head and the toes are leaves: one joint bends. A hip bone meets the root and the thigh.
  EXPECT_NEAR(cost_of_turning(kLeftToes), cost_of_turning(kHead), 1e-9);
  EXPECT_NEAR(cost_of_turning(kLeftUpperLeg), 101 * cost_of_turning(kHead), 1e-6);
}

TEST_F(PoseEnergyTest, MovesKeepRotationsAndNoMoveIsNone) {
  ChainPose pose = PoseAt(4);
  const ChainPose before = pose;
  pose.Move(Eigen::VectorXd::Zero(3 * pose.num_joints() + 3));
  EXPECT_LT((pose.rotations - before.rotations).cwiseAbs().maxCoeff(), 1e-14);
  EXPECT_EQ(pose.root_position, before.root_position);
  Random random(6);
  for (int step = 0; step < 1000; ++step) {  // products of rotations drift
    Eigen::VectorXd move(3 * pose.num_joints() + 3);
    for (double& entry : move) entry = 2 * random.Normal();
    pose.Move(move);
  }
  for (int a = 0; a < pose.num_joints(); ++a) {
    const Eigen::Matrix3d rotation = pose.rotation(a);
    EXPECT_LT((rotation * rotation.transpose() - Eigen::Matrix3d::Identity()).norm(), 1e-12);
    EXPECT_GT(rotation.determinant(), 0);
  }
}

TEST_F(PoseEnergyTest, AttractionsAddUpAndGoWithTheirFrame) {
  const ChainPose pose = PoseAt(5);
  const Eigen::Matrix3Xd target = PoseAt(2).rotations;
  PoseEnergy energy = MakeEnergy(1, .5, 0);
  const double plain = energy.Value(pose);
  energy.AddAttraction(target, .3);
  const double once = energy.Value(pose);
  const PoseEnergy copy = energy;
  energy.AddAttraction(target, .6);
  EXPECT_NEAR(energy.Value(pose) - plain, 3 * (once - plain), 1e-9);
  EXPECT_EQ(copy.Value(pose), once);  // works on a frame of its own
  Eigen::VectorXd gradient;
  Eigen::MatrixXd hessian;
  EXPECT_NEAR(energy.Linearize(pose, &gradient, &hessian), energy.Value(pose), 1e-9);
  const FrameMoments frame = ComputeFrameMoments(figure_.rig, moments_, sequence_.frame(1));
  energy.SetFrame(ComputeChainCross(moments_, frame, figure_.rig.skeleton), frame.sum_squares);
  EXPECT_EQ(energy.Value(pose), plain);
}

TEST_F(PoseEnergyTest, ChainPoseRoundTrip) {
  const Skeleton& skeleton = figure_.rig.skeleton;
  const Eigen::Vector3d center(1, 2, 3);
  const Pose pose = FromChainPose(skeleton, ToChainPose(skeleton, track_.pose(6), center), center);
  EXPECT_LT((pose.root_position - track_.pose(6).root_position).norm(), 1e-12);
  for (int j = 0; j < skeleton.num_joints(); ++j) {
    EXPECT_LT(pose.rotations[j].angularDistance(track_.pose(6).rotations[j]), 1e-7);
    EXPECT_GE(pose.rotations[j].w(), 0);
  }
}

}  // namespace
}  // namespace pleat
