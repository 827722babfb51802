#include "pleat/fitting/details.h"

#include <gtest/gtest.h>

#include <numeric>

#include "pleat/fitting/pose_fit.h"
#include "support/skinned_figure.h"
#include "support/status_matchers.h"

namespace pleat {
namespace {

using ::testing::HasSubstr;

constexpr DetailAxes kAllAxes[] = {DetailAxes::kWorld, DetailAxes::kRoot, DetailAxes::kLocal};

class DetailsTest : public ::testing::Test {
 protected:
  DetailsTest()
      : figure_(MakeSkinnedFigure()),
        track_(MakeSmoothPoses(figure_.rig.skeleton, 12, 21)),
        wave_(MakeWaveDetails(figure_, 12)),
        sequence_(MakeSkinnedSequence(figure_, track_, wave_)),
        all_(figure_.topology.num_vertices()) {
    std::iota(all_.begin(), all_.end(), 0);
  }

  SkinnedFigure figure_;
  PoseTrack track_;
  Eigen::MatrixXd wave_;
  MeshSequence sequence_;
  std::vector<int> all_;
};

TEST_F(DetailsTest, LocalDetailsAreTheOnesThatWereMade) {
  PLEAT_ASSERT_OK_AND_ASSIGN(const Eigen::MatrixXd details,
                             ComputeDetails(sequence_, figure_.rig, track_, all_));
  EXPECT_LT((details - wave_).cwiseAbs().maxCoeff(), 1e-6);
}

TEST_F(DetailsTest, ApplyIsTheInverseInAllAxes) {
  const std::vector<int> some = {3, 1, 40, 200, 401};
  for (const DetailAxes axes : kAllAxes) {
    PLEAT_ASSERT_OK_AND_ASSIGN(
        const Eigen::MatrixXd details,
        ComputeDetails(sequence_, figure_.rig, track_, some, {.axes = axes}));
    ASSERT_EQ(details.cols(), 15);
    for (int t = 0; t < 12; ++t) {
      BoneTransforms transforms;
      ComputeBoneTransforms(figure_.rig.skeleton, track_.pose(t), {}, &transforms);
      Eigen::Matrix3Xd skinned, subset(3, 5), positions;
      SkinVertices(figure_.rig.weights, figure_.rig.rest_positions, transforms, &skinned);
      for (int c = 0; c < 5; ++c) subset.col(c) = skinned.col(some[c]);
      std::vector<Eigen::Quaterniond> rotations;
      ComputeDetailRotations(axes, figure_.rig.weights, some, transforms, &rotations);
      const Eigen::VectorXd row = details.row(t).transpose();
      ApplyDetails(subset, rotations, row, &positions);
      for (int c = 0; c < 5; ++c) {
        EXPECT_LT((positions.col(c) - sequence_.FrameAsDouble(t).col(some[c])).norm(), 1e-9);
      }
      const Eigen::VectorXf single = row.cast<float>();
      ApplyDetails(subset, rotations, single, &subset);  // in place, float details
      EXPECT_LT((positions - subset).cwiseAbs().maxCoeff(), 1e-8);
    }
  }
}

TEST_F(DetailsTest, TheFullDeformationIsBeyondTheMotionOfTheRoot) {
  for (const DetailAxes axes : kAllAxes) {
    PLEAT_ASSERT_OK_AND_ASSIGN(const Eigen::MatrixXd full,
                               ComputeDetails(sequence_, figure_.rig, track_, all_,
                                              {.base = DetailBase::kRoot, .axes = axes}));
    for (int t = 0; t < 12; ++t) {
      const Pose& pose = track_.pose(t);
      BoneTransforms transforms;
      ComputeBoneTransforms(figure_.rig.skeleton, pose, {}, &transforms);
      Eigen::Matrix3Xd base;
      ComputeDetailBase(DetailBase::kRoot, figure_.rig, transforms, &base);
      // Rigid: the rest mesh turned about the root joint and moved with it.
      const Eigen::Matrix3Xd expected =
          (pose.rotations[0].toRotationMatrix() *
           (figure_.rig.rest_positions.colwise() - figure_.rig.skeleton.rest_position(0)))
              .colwise() +
          pose.root_position;
      EXPECT_LT((base - expected).cwiseAbs().maxCoeff(), 1e-12);
      std::vector<Eigen::Quaterniond> rotations;
      ComputeDetailRotations(axes, figure_.rig.weights, all_, transforms, &rotations);
      const Eigen::VectorXd row = full.row(t).transpose();
      ApplyDetails(base, rotations, row, &base);
      EXPECT_LT((base - sequence_.FrameAsDouble(t)).cwiseAbs().maxCoeff(), 1e-9);
    }
  }
}

TEST_F(DetailsTest, RootAndLocalDetailsIgnoreRigidMotionOfTheWholeBody) {
  const Eigen::Quaterniond turn = QuaternionFromExponentialMap({0.3, 2, -0.5});
  const Eigen::Vector3d shift(3, -1, 2);
  PoseTrack::Parts moved_parts = track_.parts();
  std::vector<Eigen::Matrix3Xf> moved_frames;
  for (int t = 0; t < 12; ++t) {
    moved_frames.push_back(
        ((turn.toRotationMatrix() * sequence_.FrameAsDouble(t)).colwise() + shift).cast<float>());
    moved_parts.poses[t].root_position = turn * track_.pose(t).root_position + shift;
    moved_parts.poses[t].rotations[0] = turn * track_.pose(t).rotations[0];
  }
  PLEAT_ASSERT_OK_AND_ASSIGN(const MeshSequence moved,
                             MeshSequence::Create(figure_.topology, std::move(moved_frames)));
  const PoseTrack moved_track = PoseTrack::FromValid(std::move(moved_parts));
  for (const DetailAxes axes : kAllAxes) {
    PLEAT_ASSERT_OK_AND_ASSIGN(
        const Eigen::MatrixXd before,
        ComputeDetails(sequence_, figure_.rig, track_, all_, {.axes = axes}));
    PLEAT_ASSERT_OK_AND_ASSIGN(
        const Eigen::MatrixXd after,
        ComputeDetails(moved, figure_.rig, moved_track, all_, {.axes = axes}));
    const double change = (after - before).cwiseAbs().maxCoeff();
    if (axes == DetailAxes::kWorld) {
      EXPECT_GT(change, 1e-3);
    } else {
      EXPECT_LT(change, 3e-6);
    }
  }
}

TEST_F(DetailsTest, SameForEveryThreadCount) {
  PLEAT_ASSERT_OK_AND_ASSIGN(
      const Eigen::MatrixXd one,
      ComputeDetails(sequence_, figure_.rig, track_, all_, {.num_threads = 1}));
  PLEAT_ASSERT_OK_AND_ASSIGN(
      const Eigen::MatrixXd three,
      ComputeDetails(sequence_, figure_.rig, track_, all_, {.num_threads = 3}));
  EXPECT_EQ(one, three);
}

TEST_F(DetailsTest, ASkinnedMeshHasNoDetail) {
  const MeshSequence skinned = MakeSkinnedSequence(figure_, track_);
  for (const DetailAxes axes : kAllAxes) {
    PLEAT_ASSERT_OK_AND_ASSIGN(const Eigen::MatrixXd details,
                               ComputeDetails(skinned, figure_.rig, track_, all_, {.axes = axes}));
    EXPECT_LT(details.cwiseAbs().maxCoeff(), 1e-6);  // float32 of the sequence
  }
}

TEST_F(DetailsTest, ColumnsAreThoseOfTheVerticesInTheirOrder) {
  PLEAT_ASSERT_OK_AND_ASSIGN(const Eigen::MatrixXd whole,
                             ComputeDetails(sequence_, figure_.rig, track_, all_));
  const std::vector<int> some = {17, 3, 17, 0};  // twice and out of order
  PLEAT_ASSERT_OK_AND_ASSIGN(const Eigen::MatrixXd part,
                             ComputeDetails(sequence_, figure_.rig, track_, some));
  ASSERT_EQ(part.cols(), 12);
  for (int c = 0; c < 4; ++c) {
    EXPECT_EQ(part.middleCols<3>(3 * c), whole.middleCols<3>(3 * some[c])) << c;
  }
  PLEAT_ASSERT_OK_AND_ASSIGN(const Eigen::MatrixXd none,
                             ComputeDetails(sequence_, figure_.rig, track_, {}));
  EXPECT_EQ(none.rows(), 12);
  EXPECT_EQ(none.cols(), 0);
  EXPECT_THAT(ComputeDetails(sequence_, figure_.rig, track_, {0, -1}),
              HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("vertex -1")));
}

TEST_F(DetailsTest, WrongInputIsRefusedWithWords) {
  const SkinnedFigure other = MakeSkinnedFigure({.num_rings = 4});
  EXPECT_THAT(ComputeDetails(sequence_, other.rig, track_, {0}),
              HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("rig")));
  EXPECT_THAT(ComputeDetails(sequence_, figure_.rig, track_, {0, 612}),
              HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("vertex 612")));
  PoseTrack::Parts parts = track_.parts();
  for (Pose& pose : parts.poses) pose.rotations.pop_back();
  EXPECT_THAT(ComputeDetails(sequence_, figure_.rig, PoseTrack::FromValid(std::move(parts)), {0}),
              HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("joints")));
  parts = track_.parts();
  parts.poses.pop_back();
  EXPECT_THAT(ComputeDetails(sequence_, figure_.rig, PoseTrack::FromValid(std::move(parts)), {0}),
              HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("11 frames")));
  EXPECT_THAT(ComputeDetails(sequence_, figure_.rig, track_, all_, {},
                             Progress(nullptr, [] { return true; })),
              HasStatus(absl::StatusCode::kCancelled, HasSubstr("")));
}

}  // namespace
}  // namespace pleat
