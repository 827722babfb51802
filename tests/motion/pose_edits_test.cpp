#include "pose_edits.h"

#include <gtest/gtest.h>

#include <numbers>

#include "blending.h"
#include "formats/figure_character.h"
#include "pleat/math/rotations.h"
#include "support/status_matchers.h"

namespace pleat {
namespace {

const Eigen::Vector3d kUp = Eigen::Vector3d::UnitY();

Eigen::Quaterniond Turn(double degrees, const Eigen::Vector3d& axis) {
  return Eigen::Quaterniond(Eigen::AngleAxisd(degrees * kDegree, axis.normalized()));
}
double Degrees(const Eigen::Quaterniond& rotation) {
  return ExponentialMapFromQuaternion(rotation).norm() / kDegree;
}

class PoseEditsTest : public testing::Test {
 protected:
  // So many poses at rest.
  std::vector<Pose> Rest(int num_frames) const {
    return std::vector<Pose>(static_cast<size_t>(num_frames), Pose::Rest(skeleton_));
  }

  const CharacterFile character_ = FigureCharacter(0);
  const Skeleton& skeleton_ = character_.rig.skeleton;
  const int elbow_ = skeleton_.FindJoint("leftHand");
  const auto& RotationOf(const Pose& pose) const {
    return pose.rotations[static_cast<size_t>(elbow_)];
  }
};

TEST_F(PoseEditsTest, ATurnPastHalfARoundIsScaledWithoutAJump) {
  std::vector<Pose> poses = Rest(37);
  for (size_t t = 0; t < poses.size(); ++t) {
    poses[t].rotations[static_cast<size_t>(elbow_)] = Turn(10. * static_cast<double>(t), kUp);
  }
  ScaleRotations({elbow_}, .5, &poses);
  for (size_t t = 0; t < poses.size(); ++t) {
    const Eigen::Quaterniond wanted = Turn(5. * static_cast<double>(t), kUp);
    EXPECT_GT(std::abs(RotationOf(poses[t]).dot(wanted)), 1 - 1e-9) << t;
  }
}

TEST_F(PoseEditsTest, OnlyTheJointsThatAreNamedTurn) {
  std::vector<Pose> poses = Rest(2);
  OffsetRotations({elbow_}, Turn(30, kUp), &poses);
  OffsetRotations({elbow_}, Turn(15, kUp), &poses);
  for (size_t j = 0; j < poses[1].rotations.size(); ++j) {
    const double turned = static_cast<int>(j) == elbow_ ? 45 : 0;
    EXPECT_NEAR(Degrees(poses[1].rotations[j]), turned, 1e-6) << j;
  }
}

TEST_F(PoseEditsTest, SwingAndTwistAreCutEachAtItsLimit) {
  const Eigen::Vector3d bone =
      (skeleton_.rest_position(elbow_) - skeleton_.rest_position(skeleton_.parent(elbow_)))
          .normalized();
  const Eigen::Vector3d across = bone.unitOrthogonal();
  std::vector<Pose> poses = Rest(3);
  const auto joint = static_cast<size_t>(elbow_);
  poses[0].rotations[joint] = Turn(80, across) * Turn(50, bone);
  poses[1].rotations[joint] = Turn(20, across) * Turn(50, bone);
  poses[2].rotations[joint] = Turn(20, across) * Turn(5, bone);
  const Eigen::Quaterniond within = poses[2].rotations[joint];
  LimitRotations(skeleton_, {elbow_}, 30 * kDegree, 10 * kDegree, &poses);
  EXPECT_LT(RotationOf(poses[0]).angularDistance(Turn(30, across) * Turn(10, bone)), 1e-9);
  EXPECT_LT(RotationOf(poses[1]).angularDistance(Turn(20, across) * Turn(10, bone)), 1e-9);
  EXPECT_EQ(RotationOf(poses[2]).coeffs(), within.coeffs());
}

TEST_F(PoseEditsTest, TheRootHasNoTwist) {
  std::vector<Pose> poses = Rest(1);
  poses[0].rotations[0] = Turn(90, kUp);
  LimitRotations(skeleton_, {0}, 40 * kDegree, 0, &poses);
  EXPECT_NEAR(Degrees(poses[0].rotations[0]), 40, 1e-9);
}

TEST_F(PoseEditsTest, SmoothingTakesAwayNoiseAndNeverCrossesClips) {
  std::vector<Pose> poses = Rest(40);
  for (size_t t = 0; t < 40; ++t) {
    const double noise = t % 2 == 0 ? 4 : -4;
    const double clip = t < 20 ? 0 : 60;
    poses[t].rotations[static_cast<size_t>(elbow_)] = Turn(clip + noise, kUp);
    poses[t].root_position.x() = clip / 60 + noise / 100;
  }
  std::vector<Pose> still = poses;
  SmoothRotations({elbow_}, 0, 30, {0, 20}, &still);
  EXPECT_EQ(RotationOf(still[3]).coeffs(), RotationOf(poses[3]).coeffs());
  SmoothRotations({0, elbow_}, .2, 30, {0, 20}, &poses);
  for (size_t t = 3; t < 17; ++t) {
    EXPECT_LT(Degrees(RotationOf(poses[t])), .2) << t;
    EXPECT_NEAR(poses[t].root_position.x(), 0, .01) << t;
  }
  EXPECT_LT(Degrees(RotationOf(poses[19])), 4);
  EXPECT_NEAR(Degrees(RotationOf(poses[20])), 60, 4);
  EXPECT_NEAR(poses[25].root_position.x(), 1, .01);
}

TEST_F(PoseEditsTest, TheMirrorOfARaisedLeftArmIsARaisedRightArm) {
  const BodyAxes axes = FindBodyAxes(skeleton_).value();
  std::vector<Pose> poses = Rest(2);
  const auto left = static_cast<size_t>(elbow_);
  const auto right = static_cast<size_t>(axes.mirror_joints[left]);
  poses[1].rotations[left] = Turn(50, axes.front);
  poses[1].root_position += .3 * axes.left;
  MirrorPoses(axes, {0}, &poses);
  EXPECT_LT(poses[1].rotations[right].angularDistance(Turn(-50, axes.front)), 1e-9);
  EXPECT_NEAR(Degrees(poses[1].rotations[left]), 0, 1e-9);
  // In the plane through where the clip begins.
  const Eigen::Vector3d moved = poses[1].root_position - poses[0].root_position;
  EXPECT_LT((moved + .3 * axes.left).norm(), 1e-12);
}

}  // namespace
}  // namespace pleat
