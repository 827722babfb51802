// What every pose fit must keep: it explains a frame at least as well as the truth does, it follows
// the body wherever it goes, and no number of frames, bones or vertices is too small.
#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <vector>

#include "pleat/fitting/pose_fit.h"
#include "support/skinned_figure.h"
#include "support/status_matchers.h"

namespace pleat {
namespace {

constexpr int kNumFrames = 12;

// Root mean squared distance of the vertices of one frame from `rig` in `pose`.
double RmsOfPose(const Rig& rig, const Pose& pose, const Eigen::Matrix3Xf& frame) {
  BoneTransforms transforms;
  ComputeBoneTransforms(rig.skeleton, pose, {}, &transforms);
  Eigen::Matrix3Xd positions;
  SkinVertices(rig.weights, rig.rest_positions, transforms, &positions);
  return std::sqrt((positions - frame.cast<double>()).colwise().squaredNorm().mean());
}

class PoseFitPropertiesTest : public testing::TestWithParam<PoseFitMethod> {
 protected:
  PoseFitOptions Options() const { return {.method = GetParam(), .bend_stiffness = 1e-9}; }
  PoseTrack Fit(const MeshSequence& sequence, const Rig& rig,
                PoseFitSummary* summary = nullptr) const {
    return FitPoses(sequence, rig, Options(), summary).value();
  }
  // The sequence with noise on every coordinate.
  MeshSequence Noisy(double sigma_m) const {
    Random random(9);
    std::vector<Eigen::Matrix3Xf> frames;
    for (int t = 0; t < kNumFrames; ++t) {
      frames.push_back(clean_.frame(t));
      for (float& x : frames.back().reshaped()) x += static_cast<float>(sigma_m * random.Normal());
    }
    return MeshSequence::Create(figure_.topology, std::move(frames)).value();
  }
  // The sequence and the rig seen from elsewhere: p -> scale * turn * p + shift.
  static MeshSequence Moved(const MeshSequence& sequence, double scale,
                            const Eigen::Quaterniond& turn, const Eigen::Vector3d& shift) {
    std::vector<Eigen::Matrix3Xf> frames;
    for (int t = 0; t < sequence.num_frames(); ++t) {
      const Eigen::Matrix3Xd turned = turn.toRotationMatrix() * sequence.FrameAsDouble(t);
      frames.push_back(((scale * turned).colwise() + shift).cast<float>());
    }
    return MeshSequence::Create(sequence.topology(), std::move(frames)).value();
  }

  const SkinnedFigure figure_ = MakeSkinnedFigure({.num_rings = 4, .num_sides = 4});
  const PoseTrack truth_ = MakeSmoothPoses(figure_.rig.skeleton, kNumFrames, 3);
  const MeshSequence clean_ = MakeSkinnedSequence(figure_, truth_);
};

INSTANTIATE_TEST_SUITE_P(Methods, PoseFitPropertiesTest,
                         testing::Values(PoseFitMethod::kAllJoints, PoseFitMethod::kWalk),
                         [](const auto& info) {
                           return info.param == PoseFitMethod::kWalk ? "Walk" : "AllJoints";
                         });

// Noise of sigma leaves an error of sigma sqrt(3) per vertex, less what the pose can follow.
TEST_P(PoseFitPropertiesTest, NoiseIsExplainedAtLeastAsWellAsByTheTruth) {
  for (const double sigma_m : {.001, .01, .03}) {
    const MeshSequence noisy = Noisy(sigma_m);
    PoseFitSummary summary;
    const PoseTrack track = Fit(noisy, figure_.rig, &summary);
    for (int t = 0; t < kNumFrames; ++t) {
      const double of_truth = RmsOfPose(figure_.rig, truth_.pose(t), noisy.frame(t));
      const double found = RmsOfPose(figure_.rig, track.pose(t), noisy.frame(t));
      EXPECT_NEAR(found, summary.frame_rms_m[t], 1e-6);
      // The walk is no minimum of the whole, but far from it it must not stay.
      EXPECT_LT(found, GetParam() == PoseFitMethod::kWalk ? of_truth + .03 : of_truth) << t;
      EXPECT_GT(found, .8 * of_truth) << t;
    }
  }
}

TEST_P(PoseFitPropertiesTest, ThePosesFollowTheBodyWhereverItGoes) {
  const Eigen::Quaterniond turn = QuaternionFromExponentialMap({.7, -1.9, .4});
  const Eigen::Vector3d shift(5, -3, 8);
  const MeshSequence noisy = Noisy(.005);
  const PoseTrack before = Fit(noisy, figure_.rig);
  const PoseTrack after = Fit(Moved(noisy, 1, turn, shift), figure_.rig);
  for (int t = 0; t < kNumFrames; ++t) {
    const Pose &a = before.pose(t), &b = after.pose(t);
    EXPECT_LT((b.root_position - (turn * a.root_position + shift)).norm(), 1e-3);
    EXPECT_LT(b.rotations[0].angularDistance(turn * a.rotations[0]), 5e-3);
    for (size_t j = 1; j < a.rotations.size(); ++j) {
      EXPECT_LT(b.rotations[j].angularDistance(a.rotations[j]), .02) << t << " joint " << j;
    }
  }
}

// A body in millimeters is the same body.
TEST_P(PoseFitPropertiesTest, TheUnitOfLengthDoesNotMatter) {
  Rig large = figure_.rig;
  large.rest_positions *= 1000;
  large.skeleton = large.skeleton.WithRestPositions(1000 * large.skeleton.RestPositions());
  const MeshSequence noisy = Noisy(.005);
  PoseFitSummary in_meters, in_millimeters;
  const PoseTrack a = Fit(noisy, figure_.rig, &in_meters);
  const PoseTrack b =
      Fit(Moved(noisy, 1000, Eigen::Quaterniond::Identity(), {0, 0, 0}), large, &in_millimeters);
  EXPECT_NEAR(in_millimeters.rms_m, 1000 * in_meters.rms_m, 1e-2 * in_millimeters.rms_m);
  for (int t = 0; t < kNumFrames; ++t) {
    for (size_t j = 0; j < a.pose(t).rotations.size(); ++j) {
      EXPECT_LT(b.pose(t).rotations[j].angularDistance(a.pose(t).rotations[j]), .02);
    }
  }
}

TEST_P(PoseFitPropertiesTest, OneFrameIsAClip) {
  const MeshSequence one = clean_.Subset({7});
  PoseFitSummary summary;
  const PoseTrack track = Fit(one, figure_.rig, &summary);
  ASSERT_EQ(track.num_frames(), 1);
  EXPECT_EQ(summary.worst_frames, std::vector<int>{0});
  EXPECT_EQ(summary.jitter_rad, 0);
  EXPECT_EQ(summary.frame_rms_m.size(), 1u);
}

TEST_P(PoseFitPropertiesTest, TheWorstFramesComeFirst) {
  std::vector<Eigen::Matrix3Xf> frames;
  for (int t = 0; t < kNumFrames; ++t) frames.push_back(clean_.frame(t));
  for (const int spoiled : {3, 8}) frames[spoiled].row(0).array() *= spoiled == 8 ? 3 : 2;
  PoseFitSummary summary;
  Fit(MeshSequence::Create(figure_.topology, std::move(frames)).value(), figure_.rig, &summary);
  ASSERT_EQ(summary.worst_frames.size(), 5u);
  EXPECT_EQ(std::set<int>(summary.worst_frames.begin(), summary.worst_frames.begin() + 2),
            (std::set<int>{3, 8}));
  EXPECT_TRUE(std::is_sorted(
      summary.worst_frames.begin(), summary.worst_frames.end(),
      [&](int a, int b) { return summary.frame_rms_m[a] > summary.frame_rms_m[b]; }));
}

// A root and one bone: a rigid body. It may be flat or thin.
TEST_P(PoseFitPropertiesTest, RigidBodiesOfAnyShapeComeBack) {
  const Skeleton stick = Skeleton::Create({{"root", -1, {0, 1, 0}}, {"tip", 0, {0, 2, 0}}}).value();
  const Topology triangle = Topology::Create(3, {0, 1, 2}, {3}).value();
  Rig rig;
  rig.skeleton = stick;
  rig.weights = SkinWeights::FromDense(Eigen::Vector2d(0, 1).transpose().replicate(3, 1)).value();
  for (const double width : {.5, .01}) {
    rig.rest_positions.resize(3, 3);
    rig.rest_positions << 0, width, 0, 1, 1.2, 2, .1, 0, 0;  // flat: a reflection would fit as well
    const SkinnedFigure flat{triangle, rig};
    PoseTrack::Parts poses;
    for (int t = 0; t < 6; ++t) {
      Pose pose = Pose::Rest(stick);
      pose.root_position += Eigen::Vector3d(t, -.3 * t, 2);
      pose.rotations[0] = QuaternionFromExponentialMap({.5 * t, .2 * t - 1, 3. - t});
      poses.poses.push_back(pose);
    }
    PoseFitSummary summary;
    const PoseTrack track =
        Fit(MakeSkinnedSequence(flat, PoseTrack::FromValid(poses)), rig, &summary);
    EXPECT_LT(summary.rms_m, 1e-5) << width;
    for (const Pose& pose : track.poses()) {
      for (const Eigen::Quaterniond& q : pose.rotations) EXPECT_NEAR(q.norm(), 1, 1e-9);
    }
  }
}

TEST(PoseFitEffortTest, MoreEffortNeverFitsWorse) {
  const SkinnedFigure figure = MakeSkinnedFigure({.num_rings = 4, .num_sides = 4});
  const PoseTrack truth = MakeSmoothPoses(figure.rig.skeleton, kNumFrames, 3, .9);
  const MeshSequence sequence =
      MakeSkinnedSequence(figure, truth, MakeWaveDetails(figure, kNumFrames, .03));
  const auto fit = [&](int max_iterations, int neighbor_passes) {
    PoseFitSummary summary;
    EXPECT_THAT(
        FitPoses(sequence, figure.rig,
                 {.max_iterations = max_iterations, .neighbor_passes = neighbor_passes}, &summary),
        IsOk());
    return summary;
  };
  double last = 1e9;
  for (const int max_iterations : {0, 1, 3, 10, 60}) {
    const PoseFitSummary alone = fit(max_iterations, 0), helped = fit(max_iterations, 2);
    EXPECT_LE(alone.rms_m, last + 1e-6) << max_iterations;
    EXPECT_LE(helped.rms_m, alone.rms_m + 1e-6) << max_iterations;
    EXPECT_LE(alone.mean_iterations, max_iterations);
    EXPECT_EQ(alone.num_rescued_frames, 0);
    last = alone.rms_m;
  }
}

// A pull over time must not reach from one clip into the next.
TEST(PoseFitEffortTest, SmoothnessEndsWithTheClip) {
  const SkinnedFigure figure = MakeSkinnedFigure({.num_rings = 4, .num_sides = 4});
  const PoseTrack a = MakeSmoothPoses(figure.rig.skeleton, 6, 3);
  const PoseTrack b = MakeSmoothPoses(figure.rig.skeleton, 6, 4);
  PoseTrack::Parts joined = a.parts();
  joined.poses.insert(joined.poses.end(), b.poses().begin(), b.poses().end());
  const MeshSequence both = MakeSkinnedSequence(figure, PoseTrack::FromValid(joined));
  const auto fit = [&](const MeshSequence& sequence, std::vector<int> clip_starts) {
    return FitPoses(sequence, figure.rig, {.smoothness = .1, .clip_starts = std::move(clip_starts)},
                    nullptr)
        .value();
  };
  const PoseTrack together = fit(both, {0, 6});
  const PoseTrack first = fit(both.Subset({0, 1, 2, 3, 4, 5}), {0});
  const PoseTrack as_one = fit(both, {0});
  double change = 0;
  for (int t = 0; t < 6; ++t) {
    for (size_t j = 0; j < first.pose(t).rotations.size(); ++j) {
      const Eigen::Quaterniond& expected = first.pose(t).rotations[j];
      EXPECT_EQ(together.pose(t).rotations[j].coeffs(), expected.coeffs()) << t;
      change = std::max(change, as_one.pose(t).rotations[j].angularDistance(expected));
    }
  }
  EXPECT_GT(change, .01);
}

}  // namespace
}  // namespace pleat
