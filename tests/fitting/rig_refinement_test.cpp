#include "pleat/fitting/rig_refinement.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <tuple>

#include "pleat/fitting/pose_fit.h"
#include "pleat/mesh/adjacency.h"
#include "support/skinned_figure.h"
#include "support/status_matchers.h"

namespace pleat {
namespace {

using ::testing::HasSubstr;

class RigRefinementTest : public ::testing::Test {
 protected:
  RigRefinementTest()
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

  // The rig after a fit of its poses to `sequence`.
  static absl::StatusOr<Rig> Refine(const MeshSequence& sequence, const Rig& rig,
                                    const RigRefinementOptions& options,
                                    RigRefinementSummary* summary = nullptr,
                                    const Progress& progress = {}) {
    const auto track = FitPoses(sequence, rig, {}, nullptr);
    if (!track.ok()) return track.status();
    return RefineRig(sequence, rig, *track, options, summary, progress);
  }
  // Mean over vertices of half the sum of |difference|: 0 = equal, 1 = other bones altogether.
  double WeightError(const Rig& rig) const {
    return (rig.weights.ToDense() - figure_.rig.weights.ToDense())
               .cwiseAbs()
               .rowwise()
               .sum()
               .mean() /
           2;
  }

  SkinnedFigure figure_;
  PoseTrack track_;
  Rig displaced_;
};

TEST_F(RigRefinementTest, DisplacedJointsComeBack) {
  const MeshSequence sequence = MakeSkinnedSequence(figure_, track_);
  RigRefinementSummary summary;
  PLEAT_ASSERT_OK_AND_ASSIGN(
      const Rig refined,
      Refine(sequence, displaced_,
             {.weights = false, .rest = false, .joint_prior = 1e-6, .num_rounds = 60}, &summary));
  EXPECT_LT(JointError(refined), 0.5 * JointError(displaced_));
  EXPECT_LT(summary.rms_m, 0.25 * summary.round_rms_m[0]);
  ASSERT_EQ(summary.round_rms_m.size(), 60u);
  ASSERT_EQ(summary.joint_moved_m.size(), 18u);
  EXPECT_NEAR(summary.joint_moved_m[kHead], 0, 1e-12);  // a leaf
  EXPECT_GT(summary.joint_moved_m[kLeftLowerLeg], 0.003);
  EXPECT_EQ(summary.mean_weight_change, 0);
  EXPECT_EQ(summary.rest_moved_m, 0);
}

TEST_F(RigRefinementTest, TheTruthStays) {
  const MeshSequence sequence = MakeSkinnedSequence(figure_, track_);
  PLEAT_ASSERT_OK_AND_ASSIGN(const Rig refined,
                             Refine(sequence, figure_.rig, {.weight_smoothness = 0}));
  EXPECT_LT(JointError(refined), 1e-4);
  EXPECT_LT(WeightError(refined), 2e-3);
  EXPECT_LT((refined.rest_positions - figure_.rig.rest_positions).norm(), 1e-3);
}

TEST_F(RigRefinementTest, BlurredWeightsComeBack) {
  const MeshSequence sequence = MakeSkinnedSequence(figure_, track_);
  Eigen::MatrixXd dense = figure_.rig.weights.ToDense();
  for (int b = 1; b < 18; ++b) {  // a fifth of every bone's weight goes to its parent or child
    const int other = figure_.rig.skeleton.parent(b) > 0 ? figure_.rig.skeleton.parent(b) : b + 1;
    const Eigen::VectorXd moved = 0.2 * dense.col(b);
    dense.col(b) -= moved;
    dense.col(other) += moved;
  }
  Rig blurred = figure_.rig;
  PLEAT_ASSERT_OK_AND_ASSIGN(blurred.weights, SkinWeights::FromDense(dense));
  RigRefinementSummary summary;
  PLEAT_ASSERT_OK_AND_ASSIGN(const Rig refined, Refine(sequence, blurred,
                                                       {.joints = false,
                                                        .rest = false,
                                                        .weight_smoothness = 1e-5,
                                                        .weight_prior = 1e-5,
                                                        .num_rounds = 30},
                                                       &summary));
  EXPECT_LT(WeightError(refined), 0.75 * WeightError(blurred));
  EXPECT_LT(summary.rms_m, 0.15 * summary.round_rms_m[0]);
  EXPECT_GT(summary.mean_weight_change, 0.05);
}

TEST_F(RigRefinementTest, AVertexFindsABoneNextToItsOwn) {
  const MeshSequence sequence = MakeSkinnedSequence(figure_, track_);
  std::vector<VertexInfluences> rigid = figure_.rig.weights.influences();
  for (VertexInfluences& influences : rigid) {  // only the strongest bone is left
    influences.weights = {1, 0, 0, 0};
    influences.bones[1] = influences.bones[2] = influences.bones[3] = 0;
  }
  Rig first = figure_.rig;
  PLEAT_ASSERT_OK_AND_ASSIGN(first.weights, SkinWeights::Create(18, rigid));
  PLEAT_ASSERT_OK_AND_ASSIGN(const Rig refined, Refine(sequence, first,
                                                       {.joints = false,
                                                        .rest = false,
                                                        .weight_smoothness = 0,
                                                        .weight_prior = 0,
                                                        .num_rounds = 10}));
  EXPECT_LT(WeightError(refined), 0.2 * WeightError(first));
}

TEST_F(RigRefinementTest, SmoothnessMakesNeighborsAlike) {
  const MeshSequence sequence =
      MakeSkinnedSequence(figure_, track_, MakeWaveDetails(figure_, 60, 0.02));
  const VertexAdjacency adjacency(figure_.topology);
  std::vector<double> roughness;
  for (const double smoothness : {0.0, 1e-2}) {
    PLEAT_ASSERT_OK_AND_ASSIGN(
        const Rig refined,
        Refine(sequence, figure_.rig, {.rest = false, .weight_smoothness = smoothness}));
    const Eigen::MatrixXd dense = refined.weights.ToDense();
    double sum = 0;
    for (int v = 0; v < dense.rows(); ++v) {
      for (const int32_t n : adjacency.neighbors(v)) {
        sum += (dense.row(v) - dense.row(n)).squaredNorm();
      }
    }
    roughness.push_back(sum);
  }
  EXPECT_LT(roughness[1], 0.5 * roughness[0]);
}

TEST_F(RigRefinementTest, RestMeshTakesTheMeanDetail) {
  // Every frame shows the same bumps in the vertices' own axes: they belong into the rest mesh.
  Eigen::MatrixXd details = MakeWaveDetails(figure_, 60, 0.01);
  for (int t = 1; t < 60; ++t) details.row(t) = details.row(0);
  const MeshSequence sequence = MakeSkinnedSequence(figure_, track_, details);
  RigRefinementSummary summary;
  PLEAT_ASSERT_OK_AND_ASSIGN(
      const Rig refined,
      Refine(sequence, figure_.rig,
             {.joints = false, .weights = false, .rest_smoothness = 0, .rest_prior = 1e-3},
             &summary));
  EXPECT_LT(summary.rms_m, 0.3 * summary.round_rms_m[0]);
  EXPECT_GT(summary.rest_moved_m, 0.005);
}

TEST_F(RigRefinementTest, ThePriorHoldsJointsThatTheMotionDoesNotShow) {
  // Stiff knees: any knee position explains the motion; details pull at them all the same.
  PoseTrack::Parts stiff = track_.parts();
  for (Pose& pose : stiff.poses) {
    pose.rotations[kLeftLowerLeg] = pose.rotations[kRightLowerLeg] = Eigen::Quaterniond::Identity();
    pose.rotations[kLeftFoot] = pose.rotations[kRightFoot] = Eigen::Quaterniond::Identity();
  }
  const MeshSequence sequence =
      MakeSkinnedSequence(figure_, PoseTrack::FromValid(stiff), MakeWaveDetails(figure_, 60, 0.01));
  RigRefinementSummary summary;
  PLEAT_ASSERT_OK_AND_ASSIGN(const Rig refined, Refine(sequence, figure_.rig, {}, &summary));
  EXPECT_LT(summary.joint_moved_m[kLeftLowerLeg], 0.01);
  EXPECT_LT(summary.joint_moved_m[kRightLowerLeg], 0.01);
  EXPECT_LE(summary.rms_m, summary.round_rms_m[0]);
}

TEST_F(RigRefinementTest, LockedJointsStayAndTheOthersComeBackAllTheSame) {
  const MeshSequence sequence = MakeSkinnedSequence(figure_, track_);
  Rig partly = displaced_;  // the truth where it will be locked
  Eigen::Matrix3Xd joints = displaced_.skeleton.RestPositions();
  const std::vector<int> locked = {0, 2, 5, 13};
  for (const int j : locked) joints.col(j) = figure_.rig.skeleton.rest_position(j);
  partly.skeleton = partly.skeleton.WithRestPositions(joints);
  RigRefinementOptions options{
      .weights = false, .rest = false, .joint_prior = 1e-6, .num_rounds = 60};
  options.locked_joints = locked;
  RigRefinementSummary summary;
  PLEAT_ASSERT_OK_AND_ASSIGN(const Rig refined, Refine(sequence, partly, options, &summary));
  for (const int j : locked) {
    EXPECT_EQ(refined.skeleton.rest_position(j), partly.skeleton.rest_position(j)) << j;
    EXPECT_EQ(summary.joint_moved_m[j], 0);
  }
  EXPECT_LT(JointError(refined), 0.5 * JointError(partly));
  // Also in a full refinement, and where the lock is wrong.
  options = {.locked_joints = {4, 8}};
  PLEAT_ASSERT_OK_AND_ASSIGN(const Rig full, Refine(sequence, displaced_, options));
  for (int j = 0; j < 18; ++j) {
    if (displaced_.skeleton.children(j).empty()) continue;
    const bool stays = full.skeleton.rest_position(j) == displaced_.skeleton.rest_position(j);
    EXPECT_EQ(stays, j == 4 || j == 8) << j;
  }
}

TEST_F(RigRefinementTest, SameForEveryThreadCount) {
  const MeshSequence sequence =
      MakeSkinnedSequence(figure_, track_, MakeWaveDetails(figure_, 60, 0.01));
  PLEAT_ASSERT_OK_AND_ASSIGN(const Rig one, Refine(sequence, displaced_, {.num_threads = 1}));
  PLEAT_ASSERT_OK_AND_ASSIGN(const Rig three, Refine(sequence, displaced_, {.num_threads = 3}));
  EXPECT_EQ(one.skeleton.RestPositions(), three.skeleton.RestPositions());
  EXPECT_EQ(one.weights.ToDense(), three.weights.ToDense());
  EXPECT_EQ(one.rest_positions, three.rest_positions);
}

// Each kind of unknown alone, and all together, explains the motion better than the first rig.
TEST_F(RigRefinementTest, WhateverMayMoveTheErrorFalls) {
  const PoseTrack few = MakeSmoothPoses(figure_.rig.skeleton, 16, 6, .5);
  const MeshSequence sequence =
      MakeSkinnedSequence(figure_, few, MakeWaveDetails(figure_, 16, .01));
  for (const auto& [joints, weights, rest] :
       {std::tuple(true, false, false), std::tuple(false, true, false),
        std::tuple(false, false, true), std::tuple(true, true, true)}) {
    RigRefinementSummary summary;
    PLEAT_ASSERT_OK_AND_ASSIGN(
        const Rig refined,
        Refine(sequence, displaced_,
               {.joints = joints, .weights = weights, .rest = rest, .num_rounds = 2}, &summary));
    EXPECT_LT(summary.rms_m, summary.round_rms_m[0]);
    EXPECT_LE(summary.round_rms_m[1], summary.round_rms_m[0]);
    const bool same_joints =
        refined.skeleton.RestPositions() == displaced_.skeleton.RestPositions();
    EXPECT_EQ(same_joints, !joints);
    EXPECT_EQ(summary.mean_weight_change > 0, weights);
    EXPECT_EQ(summary.rest_moved_m > 0, rest);
    const Eigen::VectorXd sums = refined.weights.ToDense().rowwise().sum();
    EXPECT_LT((sums.array() - 1).abs().maxCoeff(), 1e-5);
  }
  // Nothing may move: the rig stays, and its error is told.
  RigRefinementSummary summary;
  PLEAT_ASSERT_OK_AND_ASSIGN(
      const Rig same,
      Refine(sequence, displaced_, {.joints = false, .weights = false, .rest = false}, &summary));
  EXPECT_EQ(same.rest_positions, displaced_.rest_positions);
  EXPECT_EQ(same.weights.ToDense(), displaced_.weights.ToDense());
  EXPECT_LE(summary.rms_m, summary.round_rms_m[0]);
}

TEST_F(RigRefinementTest, LongSequencesAreRefinedOnSomeOfTheirFrames) {
  const MeshSequence sequence = MakeSkinnedSequence(figure_, track_);
  RigRefinementOptions options = RigRefinementOptions::JointsOnly();
  options.joint_prior = 1e-3;
  options.max_frames = 12;
  std::vector<double> fractions;
  const Progress progress(
      [&](const ProgressUpdate& update) { fractions.push_back(update.fraction); }, nullptr);
  PLEAT_ASSERT_OK_AND_ASSIGN(const Rig few,
                             Refine(sequence, displaced_, options, nullptr, progress));
  EXPECT_LT(JointError(few), JointError(displaced_));
  EXPECT_TRUE(std::is_sorted(fractions.begin(), fractions.end()));
  EXPECT_NEAR(fractions.back(), 1, 1e-12);
  // These are every fifth frame.
  std::vector<int> fifth;
  for (int t = 0; t < 60; t += 5) fifth.push_back(t);
  const auto track = FitPoses(sequence, displaced_, {}, nullptr);
  PoseTrack::Parts poses;
  for (const int t : fifth) poses.poses.push_back(track->pose(t));
  PLEAT_ASSERT_OK_AND_ASSIGN(const Rig same,
                             RefineRig(sequence.Subset(fifth), displaced_,
                                       PoseTrack::FromValid(std::move(poses)), options, nullptr));
  EXPECT_EQ(same.skeleton.RestPositions(), few.skeleton.RestPositions());
}

TEST_F(RigRefinementTest, OptionsOutOfRangeAreRefused) {
  const MeshSequence sequence = MakeSkinnedSequence(figure_, track_);
  for (double RigRefinementOptions::*pull :
       {&RigRefinementOptions::joint_prior, &RigRefinementOptions::weight_smoothness,
        &RigRefinementOptions::weight_prior, &RigRefinementOptions::rest_smoothness,
        &RigRefinementOptions::rest_prior}) {
    for (const double wrong : {-1e-9, std::nan("")}) {
      RigRefinementOptions options;
      options.*pull = wrong;
      EXPECT_THAT(RefineRig(sequence, displaced_, track_, options, nullptr),
                  HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("must be positive")));
    }
  }
  for (int RigRefinementOptions::*count :
       {&RigRefinementOptions::num_rounds, &RigRefinementOptions::max_frames}) {
    RigRefinementOptions options;
    options.*count = 0;
    EXPECT_THAT(RefineRig(sequence, displaced_, track_, options, nullptr),
                HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("must be positive")));
  }
}

TEST_F(RigRefinementTest, WrongInputIsRefusedWithWords) {
  const MeshSequence sequence = MakeSkinnedSequence(figure_, track_);
  const auto invalid = absl::StatusCode::kInvalidArgument;
  const Rig other = MakeSkinnedFigure({.num_rings = 4}).rig;
  EXPECT_THAT(RefineRig(sequence, other, track_, {}, nullptr),
              HasStatus(invalid, HasSubstr("vertices")));
  EXPECT_THAT(RefineRig(sequence, displaced_, PoseTrack{}, {}, nullptr),
              HasStatus(invalid, HasSubstr("0 frames")));
  PoseTrack::Parts short_poses = track_.parts();
  for (Pose& pose : short_poses.poses) pose.rotations.pop_back();
  EXPECT_THAT(RefineRig(sequence, displaced_, PoseTrack::FromValid(short_poses), {}, nullptr),
              HasStatus(invalid, HasSubstr("17 rotations")));
  EXPECT_THAT(RefineRig(sequence, displaced_, track_, {.joint_prior = 0}, nullptr),
              HasStatus(invalid, HasSubstr("prior")));
  EXPECT_THAT(RefineRig(sequence, displaced_, track_, {.weight_smoothness = -1}, nullptr),
              HasStatus(invalid, HasSubstr("-1")));
  EXPECT_THAT(
      RefineRig(sequence, displaced_, track_, {}, nullptr, Progress(nullptr, [] { return true; })),
      HasStatus(absl::StatusCode::kCancelled, HasSubstr("")));
  EXPECT_THAT(Refine(sequence, displaced_, {.locked_joints = {18}}),
              HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("locked joint 18")));
}

}  // namespace
}  // namespace pleat
