#include "pleat/fitting/pose_fit.h"

#include <gtest/gtest.h>

#include "support/skinned_figure.h"
#include "support/status_matchers.h"

namespace pleat {
namespace {

using ::testing::HasSubstr;

Eigen::Matrix3Xd Skin(const Rig& rig, const Pose& pose) {
  BoneTransforms transforms;
  ComputeBoneTransforms(rig.skeleton, pose, {}, &transforms);
  Eigen::Matrix3Xd positions;
  SkinVertices(rig.weights, rig.rest_positions, transforms, &positions);
  return positions;
}

double Rms(const MeshSequence& sequence, const Rig& rig, const PoseTrack& track, int t) {
  return std::sqrt((Skin(rig, track.pose(t)) - sequence.FrameAsDouble(t)).squaredNorm() /
                   sequence.num_vertices());
}

class PoseFitTest : public ::testing::Test {
 protected:
  PoseFitTest()
      : figure_(MakeSkinnedFigure()), truth_(MakeSmoothPoses(figure_.rig.skeleton, 30, 2)) {}
  SkinnedFigure figure_;
  PoseTrack truth_;
};

TEST_F(PoseFitTest, NoiseFreeMotionIsRecovered) {
  const MeshSequence sequence = MakeSkinnedSequence(figure_, truth_);
  PoseFitSummary summary;
  PLEAT_ASSERT_OK_AND_ASSIGN(const PoseTrack track,
                             FitPoses(sequence, figure_.rig, {.bend_stiffness = 1e-9}, &summary));
  ASSERT_EQ(track.num_frames(), 30);
  EXPECT_EQ(track.fps(), 30);
  EXPECT_LT(summary.rms_m, 2e-5);
  ASSERT_EQ(summary.worst_frames.size(), 5u);
  for (int t = 0; t < 30; ++t) {
    EXPECT_NEAR(summary.frame_rms_m[t], Rms(sequence, figure_.rig, track, t), 1e-6);
    EXPECT_LE(summary.frame_rms_m[t], summary.frame_rms_m[summary.worst_frames[0]]);
    Pose expected = truth_.pose(t);
    FixRootGauge(figure_.rig.skeleton, &expected);
    EXPECT_LT((track.pose(t).root_position - expected.root_position).norm(), 1e-4);
    for (int j = 0; j < 18; ++j) {
      EXPECT_LT(track.pose(t).rotations[j].angularDistance(expected.rotations[j]), 2e-3)
          << "frame " << t << " joint " << j;
    }
  }
}

TEST_F(PoseFitTest, AllJointsBeatTheWalkWhenDetailsPullAtTheMesh) {
  const MeshSequence sequence =
      MakeSkinnedSequence(figure_, truth_, MakeWaveDetails(figure_, 30, 0.02));
  PoseFitSummary all, walk;
  PLEAT_ASSERT_OK_AND_ASSIGN(const PoseTrack a, FitPoses(sequence, figure_.rig, {}, &all));
  PLEAT_ASSERT_OK_AND_ASSIGN(
      const PoseTrack b, FitPoses(sequence, figure_.rig, {.method = PoseFitMethod::kWalk}, &walk));
  EXPECT_LT(all.rms_m, walk.rms_m);
  EXPECT_LT(walk.rms_m, 0.1);
  EXPECT_LT(all.rms_m, 0.03);
  EXPECT_EQ(walk.mean_iterations, 1);
}

TEST_F(PoseFitTest, SameResultForEveryThreadCount) {
  const MeshSequence sequence =
      MakeSkinnedSequence(figure_, truth_, MakeWaveDetails(figure_, 30, 0.02));
  for (const double smoothness : {0.0, 0.01}) {
    PoseFitOptions options{.smoothness = smoothness, .clip_starts = {0, 13}, .num_threads = 1};
    PLEAT_ASSERT_OK_AND_ASSIGN(const PoseTrack one,
                               FitPoses(sequence, figure_.rig, options, nullptr));
    for (const int threads : {2, 3}) {
      options.num_threads = threads;
      PLEAT_ASSERT_OK_AND_ASSIGN(const PoseTrack many,
                                 FitPoses(sequence, figure_.rig, options, nullptr));
      for (int t = 0; t < 30; ++t) {
        EXPECT_EQ(one.pose(t).root_position, many.pose(t).root_position);
        for (int j = 0; j < 18; ++j) {
          EXPECT_EQ(one.pose(t).rotations[j].coeffs(), many.pose(t).rotations[j].coeffs());
        }
      }
    }
  }
}

TEST_F(PoseFitTest, FramesOfOneClipDoNotDependOnAnother) {
  const MeshSequence sequence =
      MakeSkinnedSequence(figure_, truth_, MakeWaveDetails(figure_, 30, 0.02));
  std::vector<int> second(17);
  for (int i = 0; i < 17; ++i) second[i] = 13 + i;
  for (const PoseFitMethod method : {PoseFitMethod::kAllJoints, PoseFitMethod::kWalk}) {
    PoseFitOptions options{.method = method, .smoothness = 0.01, .clip_starts = {0, 13}};
    PLEAT_ASSERT_OK_AND_ASSIGN(const PoseTrack both,
                               FitPoses(sequence, figure_.rig, options, nullptr));
    EXPECT_EQ(both.clip_starts(), (std::vector<int>{0, 13}));
    // Smoothing alternates even and odd frames, so compare where the walk is the only history.
    if (method == PoseFitMethod::kAllJoints) continue;
    options.clip_starts = {0};
    PLEAT_ASSERT_OK_AND_ASSIGN(const PoseTrack alone,
                               FitPoses(sequence.Subset(second), figure_.rig, options, nullptr));
    for (int i = 0; i < 17; ++i) {
      EXPECT_EQ(alone.pose(i).root_position, both.pose(13 + i).root_position);
    }
  }
}

TEST_F(PoseFitTest, ABodyThatJumpsIsNotLost) {
  // Frames in random order: no previous frame helps.
  std::vector<int> order = {17, 3, 29, 0, 22, 8, 14, 27, 5};
  const MeshSequence sequence = MakeSkinnedSequence(figure_, truth_).Subset(order);
  PoseFitSummary summary;
  PLEAT_ASSERT_OK_AND_ASSIGN(const PoseTrack track,
                             FitPoses(sequence, figure_.rig, {.bend_stiffness = 1e-9}, &summary));
  EXPECT_LT(summary.rms_m, 2e-5);
}

TEST_F(PoseFitTest, SmoothnessCutsJitterAtLittleCost) {
  // Noise on every vertex makes fitted rotations shake.
  Eigen::MatrixXd noise = MakeWaveDetails(figure_, 30, 0);
  Random random(8);
  for (double& entry : noise.reshaped()) entry = 0.01 * random.Normal();
  const MeshSequence sequence = MakeSkinnedSequence(figure_, truth_, noise);
  PoseFitSummary plain, smooth;
  PLEAT_ASSERT_OK_AND_ASSIGN(const PoseTrack a, FitPoses(sequence, figure_.rig, {}, &plain));
  PLEAT_ASSERT_OK_AND_ASSIGN(const PoseTrack b,
                             FitPoses(sequence, figure_.rig, {.smoothness = 0.01}, &smooth));
  EXPECT_LT(smooth.jitter_rad, 0.9 * plain.jitter_rad);
  EXPECT_EQ(smooth.jitter_rad, RotationJitter(b));
  EXPECT_EQ(plain.jitter_rad, RotationJitter(a));
  EXPECT_EQ(smooth.unsmoothed_jitter_rad, plain.jitter_rad);
  EXPECT_EQ(smooth.unsmoothed_rms_m, plain.rms_m);
  EXPECT_EQ(plain.unsmoothed_rms_m, plain.rms_m);
  EXPECT_LT(smooth.rms_m, 1.02 * plain.rms_m);
  EXPECT_GE(smooth.rms_m, plain.rms_m);
}

TEST_F(PoseFitTest, QuaternionsKeepTheirSignThroughFullTurns) {
  // The body turns three times about itself, the forearm swings half way round and back.
  PoseTrack::Parts turning = truth_.parts();
  for (int t = 0; t < 30; ++t) {
    turning.poses[t].rotations[0] =
        Eigen::AngleAxisd(0.65 * t, Eigen::Vector3d::UnitY()) * turning.poses[t].rotations[0];
    turning.poses[t].rotations[kLeftLowerArm] =
        Eigen::AngleAxisd(3.5 * std::sin(0.2 * t), Eigen::Vector3d::UnitX());
  }
  PLEAT_ASSERT_OK_AND_ASSIGN(
      const PoseTrack track,
      FitPoses(MakeSkinnedSequence(figure_, PoseTrack::FromValid(turning)), figure_.rig,
               {.bend_stiffness = 1e-9, .clip_starts = {0, 20}}, nullptr));
  bool negative = false;
  for (int t = 1; t < 30; ++t) {
    for (int j = 0; j < 18; ++j) {
      if (t != 20) {
        EXPECT_GT(track.pose(t).rotations[j].dot(track.pose(t - 1).rotations[j]), 0.5);
      }
      negative |= track.pose(t).rotations[j].w() < 0;
    }
  }
  EXPECT_TRUE(negative);
  for (int j = 0; j < 18; ++j) EXPECT_GE(track.pose(20).rotations[j].w(), 0);  // a new clip
}

TEST_F(PoseFitTest, JitterIsTheSecondDifferenceOfRotations) {
  PoseTrack::Parts steady;
  for (int t = 0; t < 6; ++t) {
    Pose pose = Pose::Rest(figure_.rig.skeleton);
    pose.rotations[kHead] = Eigen::AngleAxisd(0.3 * t, Eigen::Vector3d::UnitY());
    steady.poses.push_back(pose);
  }
  EXPECT_NEAR(RotationJitter(PoseTrack::FromValid(steady)), 0, 1e-7);
  steady.poses[5].rotations[kHead] = Eigen::AngleAxisd(0.3 * 5 + 0.1, Eigen::Vector3d::UnitY());
  EXPECT_NEAR(RotationJitter(PoseTrack::FromValid(steady)), 0.1 / std::sqrt(4 * 18), 1e-7);
  steady.clip_starts = {0, 4};  // now frame 5 belongs to a clip of two frames
  EXPECT_NEAR(RotationJitter(PoseTrack::FromValid(steady)), 0, 1e-7);
  steady.poses.resize(2);
  steady.clip_starts = {0};
  EXPECT_EQ(RotationJitter(PoseTrack::FromValid(steady)), 0);
}

TEST_F(PoseFitTest, RootGaugeLeavesTheMesh) {
  for (Pose pose : truth_.poses()) {
    const Eigen::Matrix3Xd before = Skin(figure_.rig, pose);
    FixRootGauge(figure_.rig.skeleton, &pose);
    EXPECT_LT((Skin(figure_.rig, pose) - before).cwiseAbs().maxCoeff(), 1e-12);
    // The hip bones are now symmetric about the root.
    const Eigen::Quaterniond &left = pose.rotations[kLeftUpperLeg],
                             &right = pose.rotations[kRightUpperLeg];
    EXPECT_NEAR(left.angularDistance(right.conjugate()), 0, 1e-6);
    const Pose once = pose;
    FixRootGauge(figure_.rig.skeleton, &pose);
    EXPECT_NEAR(pose.rotations[0].angularDistance(once.rotations[0]), 0, 1e-6);
  }
}

TEST_F(PoseFitTest, RootGaugeOfAForeignSkeletonUsesTheRootsChildren) {
  const Skeleton skeleton = *Skeleton::Create({{"pelvis", -1, {0, 1, 0}},
                                               {"a", 0, {0.1, 1, 0}},
                                               {"b", 0, {-0.1, 1, 0}},
                                               {"c", 1, {0.1, 0.5, 0}}});
  Pose pose = Pose::Rest(skeleton);
  pose.rotations[1] = QuaternionFromExponentialMap({0, 0.3, 0});
  pose.rotations[2] = QuaternionFromExponentialMap({0, 0.5, 0});
  FixRootGauge(skeleton, &pose);
  EXPECT_NEAR(ExponentialMapFromQuaternion(pose.rotations[0]).y(), 0.4, 1e-9);
  EXPECT_NEAR(ExponentialMapFromQuaternion(pose.rotations[1]).y(), -0.1, 1e-9);
  EXPECT_NEAR(pose.rotations[3].angularDistance(Eigen::Quaterniond::Identity()), 0, 1e-9);
}

TEST_F(PoseFitTest, WrongInputIsRefusedWithWords) {
  const MeshSequence sequence = MakeSkinnedSequence(figure_, truth_);
  const SkinnedFigure other = MakeSkinnedFigure({.num_rings = 4});
  EXPECT_THAT(FitPoses(sequence, other.rig, {}, nullptr),
              HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("vertices")));
  for (const std::vector<int>& starts :
       {std::vector<int>{}, {1}, {0, 5, 5}, {0, 30}, {0, 7, 3}, {0, -1}}) {
    EXPECT_THAT(FitPoses(sequence, figure_.rig, {.clip_starts = starts}, nullptr),
                HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("clip starts")));
  }
}

TEST_F(PoseFitTest, CancellationStopsTheFit) {
  const MeshSequence sequence = MakeSkinnedSequence(figure_, truth_);
  const Progress cancelled(nullptr, [] { return true; });
  EXPECT_THAT(FitPoses(sequence, figure_.rig, {}, nullptr, cancelled),
              HasStatus(absl::StatusCode::kCancelled, HasSubstr("")));
  double last = 0;
  const Progress watched(
      [&](const ProgressUpdate& update) {
        EXPECT_GE(update.fraction, last);
        last = update.fraction;
      },
      nullptr);
  EXPECT_THAT(FitPoses(sequence, figure_.rig, {}, nullptr, watched), IsOk());
  EXPECT_NEAR(last, 1, 1e-9);
}

}  // namespace
}  // namespace pleat
