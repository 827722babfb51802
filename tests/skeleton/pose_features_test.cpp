#include "pleat/skeleton/pose_features.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "pleat/math/rotations.h"
#include "pleat/skeleton/human_template.h"
#include "support/smooth_poses.h"

namespace pleat {
namespace {

constexpr RotationRepresentation kAll[] = {RotationRepresentation::kExponentialMap,
                                           RotationRepresentation::kEuler,
                                           RotationRepresentation::kQuaternion};

Eigen::MatrixXd Rows(const PoseFeatureOptions& options, const PoseTrack& track) {
  return PoseFeatures(options, 18, PoseFeatures::Reference(options, track)).ComputeTrack(track);
}

TEST(PoseFeaturesTest, SizesAreThoseOfThePaper) {
  const PoseTrack track = MakeSmoothPoses(HumanTemplate(), 4, 1);
  EXPECT_EQ(Rows({}, track).cols(), 102);  // 2 frames x 17 bones x 3 angles
  EXPECT_EQ(Rows({.representation = RotationRepresentation::kQuaternion}, track).cols(), 136);
  EXPECT_EQ(Rows({.history = 1}, track).cols(), 51);
  EXPECT_EQ(Rows({.history = 3}, track).cols(), 153);
}

TEST(PoseFeaturesTest, RowsHoldThePoseThenItsPredecessor) {
  const PoseTrack track = MakeSmoothPoses(HumanTemplate(), 6, 1);
  const Eigen::MatrixXd rows = Rows({}, track);
  for (int t = 0; t < 6; ++t) {
    for (int j = 1; j < 18; ++j) {
      const Eigen::Vector3d w = ExponentialMapFromQuaternion(track.pose(t).rotations[j]);
      EXPECT_LT((rows.block<1, 3>(t, 3 * (j - 1)).transpose() - w).norm(), 1e-9);
    }
    if (t == 0) continue;
    // The predecessor stands there as itself or as the difference to its successor.
    const Eigen::RowVectorXd before = rows.row(t - 1).head(51), tail = rows.row(t).tail(51);
    EXPECT_LT(std::min((tail - before).norm(), (rows.row(t).head(51) - tail - before).norm()),
              1e-12);
  }
}

TEST(PoseFeaturesTest, RootDoesNotMatter) {
  const PoseTrack track = MakeSmoothPoses(HumanTemplate(), 8, 1);
  PoseTrack::Parts parts = track.parts();
  for (Pose& pose : parts.poses) {
    pose.root_position += Eigen::Vector3d(5, 6, 7);
    pose.rotations[0] = QuaternionFromExponentialMap({1, 2, 3}) * pose.rotations[0];
  }
  const PoseTrack moved = PoseTrack::FromValid(std::move(parts));
  for (const RotationRepresentation representation : kAll) {
    EXPECT_EQ(Rows({representation}, track), Rows({representation}, moved));
  }
}

TEST(PoseFeaturesTest, QuaternionSignDoesNotMatter) {
  const PoseTrack track = MakeSmoothPoses(HumanTemplate(), 8, 1);
  PoseTrack::Parts parts = track.parts();
  for (size_t t = 0; t < parts.poses.size(); t += 2) {
    for (Eigen::Quaterniond& rotation : parts.poses[t].rotations) rotation.coeffs() *= -1;
  }
  const PoseTrack flipped = PoseTrack::FromValid(std::move(parts));
  for (const RotationRepresentation representation : kAll) {
    EXPECT_LT((Rows({representation}, track) - Rows({representation}, flipped)).norm(), 1e-9);
  }
}

TEST(PoseFeaturesTest, ARotationBeyondPiStaysContinuous) {
  // One arm turns slowly through 270 degrees about one axis.
  PoseTrack::Parts parts;
  for (int t = 0; t < 28; ++t) {
    Pose pose = Pose::Rest(HumanTemplate());
    pose.rotations[kLeftHand] = QuaternionFromExponentialMap({0, 0, 0.17 * t});
    parts.poses.push_back(pose);
  }
  const Eigen::MatrixXd rows = Rows({.history = 1}, PoseTrack::FromValid(std::move(parts)));
  const Eigen::VectorXd angle = rows.col(3 * (kLeftHand - 1) + 2);
  for (int t = 1; t < 28; ++t) EXPECT_NEAR(angle[t] - angle[t - 1], 0.17, 1e-9);
}

TEST(PoseFeaturesTest, HistoryStaysInsideItsClip) {
  const PoseTrack whole = MakeSmoothPoses(HumanTemplate(), 10, 1);
  const PoseFeatureOptions options;
  const Eigen::VectorXd reference = PoseFeatures::Reference(options, whole);
  const PoseTrack cut = PoseTrack::FromValid({.poses = whole.poses(), .clip_starts = {0, 6}});
  const Eigen::MatrixXd both = PoseFeatures(options, 18, reference).ComputeTrack(cut);
  const PoseTrack second = whole.Subset({6, 7, 8, 9});
  const Eigen::MatrixXd alone = PoseFeatures(options, 18, reference).ComputeTrack(second);
  EXPECT_EQ(both.bottomRows(4), alone);
}

}  // namespace
}  // namespace pleat
