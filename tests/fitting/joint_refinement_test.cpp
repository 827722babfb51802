#include "pleat/fitting/joint_refinement.h"

#include <gtest/gtest.h>

#include "support/skinned_figure.h"
#include "support/status_matchers.h"

namespace pleat {
namespace {

using ::testing::HasSubstr;

class JointRefinementTest : public ::testing::Test {
 protected:
  JointRefinementTest()
      : figure_(MakeSkinnedFigure()),
        track_(MakeSmoothPoses(figure_.rig.skeleton, 60, 6, 0.5)),
        displaced_(figure_.rig) {
    Random random(12);
    Eigen::Matrix3Xd joints = figure_.rig.skeleton.RestPositions();
    for (int j = 0; j < 18; ++j) {
      if (figure_.rig.skeleton.children(j).empty()) continue;
      joints.col(j) += 0.02 * Eigen::Vector3d(random.Normal(), random.Normal(), random.Normal());
    }
    displaced_.skeleton = displaced_.skeleton.WithRestPositions(joints);
  }
  double JointError(const Rig& rig) const {
    return (rig.skeleton.RestPositions() - figure_.rig.skeleton.RestPositions())
        .colwise()
        .norm()
        .mean();
  }

  SkinnedFigure figure_;
  PoseTrack track_;
  Rig displaced_;
};

TEST_F(JointRefinementTest, DisplacedJointsComeBack) {
  const MeshSequence sequence = MakeSkinnedSequence(figure_, track_);
  JointRefinementSummary summary;
  PLEAT_ASSERT_OK_AND_ASSIGN(
      const Rig refined,
      RefineJoints(sequence, displaced_, {.prior = 1e-6, .num_rounds = 60}, &summary));
  EXPECT_LT(JointError(refined), 0.5 * JointError(displaced_));
  EXPECT_LT(summary.rms_m, 0.25 * summary.round_rms_m[0]);
  ASSERT_EQ(summary.round_rms_m.size(), 60u);
  ASSERT_EQ(summary.moved_m.size(), 18u);
  EXPECT_NEAR(summary.moved_m[kHead], 0, 1e-12);  // a leaf
  EXPECT_GT(summary.moved_m[kLeftLowerLeg], 0.003);
}

TEST_F(JointRefinementTest, TheTruthStays) {
  const MeshSequence sequence = MakeSkinnedSequence(figure_, track_);
  PLEAT_ASSERT_OK_AND_ASSIGN(const Rig refined, RefineJoints(sequence, figure_.rig, {}, nullptr));
  EXPECT_LT(JointError(refined), 5e-5);
}

TEST_F(JointRefinementTest, ThePriorHoldsJointsThatTheMotionDoesNotShow) {
  // Stiff knees: any knee position explains the motion; details pull at them all the same.
  PoseTrack stiff = track_;
  for (Pose& pose : stiff.poses) {
    pose.rotations[kLeftLowerLeg] = pose.rotations[kRightLowerLeg] = Eigen::Quaterniond::Identity();
    pose.rotations[kLeftFoot] = pose.rotations[kRightFoot] = Eigen::Quaterniond::Identity();
  }
  const MeshSequence sequence =
      MakeSkinnedSequence(figure_, stiff, MakeWaveDetails(figure_, 60, 0.01));
  JointRefinementSummary summary;
  PLEAT_ASSERT_OK_AND_ASSIGN(const Rig refined, RefineJoints(sequence, figure_.rig, {}, &summary));
  EXPECT_LT(summary.moved_m[kLeftLowerLeg], 0.01);
  EXPECT_LT(summary.moved_m[kRightLowerLeg], 0.01);
  EXPECT_LE(summary.rms_m, summary.round_rms_m[0]);
}

TEST_F(JointRefinementTest, SameForEveryThreadCount) {
  const MeshSequence sequence = MakeSkinnedSequence(figure_, track_);
  PLEAT_ASSERT_OK_AND_ASSIGN(const Rig one,
                             RefineJoints(sequence, displaced_, {.num_threads = 1}, nullptr));
  PLEAT_ASSERT_OK_AND_ASSIGN(const Rig three,
                             RefineJoints(sequence, displaced_, {.num_threads = 3}, nullptr));
  EXPECT_EQ(one.skeleton.RestPositions(), three.skeleton.RestPositions());
}

TEST_F(JointRefinementTest, WrongInputIsRefusedWithWords) {
  const MeshSequence sequence = MakeSkinnedSequence(figure_, track_);
  const auto invalid = absl::StatusCode::kInvalidArgument;
  EXPECT_THAT(RefineJoints(sequence, MakeSkinnedFigure({.num_rings = 4}).rig, {}, nullptr),
              HasStatus(invalid, HasSubstr("vertices")));
  EXPECT_THAT(RefineJoints(sequence, displaced_, {.prior = 0}, nullptr),
              HasStatus(invalid, HasSubstr("prior")));
  EXPECT_THAT(
      RefineJoints(sequence, displaced_, {}, nullptr, Progress(nullptr, [] { return true; })),
      HasStatus(absl::StatusCode::kCancelled, HasSubstr("")));
}

}  // namespace
}  // namespace pleat
