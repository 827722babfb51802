#include "pleat/rigging/embedding.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "support/capsule_figure.h"
#include "support/status_matchers.h"

namespace pleat {
namespace {

using ::testing::_;

absl::StatusOr<Embedding> Embed(const TriangleMesh& mesh, const EmbeddingOptions& options = {},
                                int resolution = 128) {
  absl::StatusOr<BodyVolume> volume =
      ComputeBodyVolume(MakeTopology(mesh), mesh.positions, {.resolution = resolution});
  if (!volume.ok()) return volume.status();
  return EmbedSkeleton(*volume, options);
}

// Mean distance over the joints of arms and legs, meters.
double LimbError(const Eigen::Matrix3Xd& joints, const Eigen::Matrix3Xd& truth) {
  return (joints - truth).rightCols(kNumHumanJoints - kLeftUpperLeg).colwise().norm().mean();
}

TEST(EmbeddingTest, FindsTheJointsOfAFigure) {
  const CapsuleFigure figure = MakeCapsuleFigure();
  PLEAT_ASSERT_OK_AND_ASSIGN(const Embedding embedding, Embed(figure.mesh));
  EXPECT_EQ(embedding.yaw_degrees, 0);
  EXPECT_LT(embedding.residual, .03);
  EXPECT_LT(embedding.uncovered_share, .01);
  EXPECT_LT(LimbError(embedding.joints, figure.joints), .05);
  EXPECT_LT((embedding.joints.col(kHead) - figure.joints.col(kHead)).norm(), .08);
}

TEST(EmbeddingTest, FindsTheJointsUnderASkirt) {
  const CapsuleFigure figure = MakeCapsuleFigure({.skirt = true});
  PLEAT_ASSERT_OK_AND_ASSIGN(const Embedding embedding, Embed(figure.mesh));
  EXPECT_EQ(embedding.yaw_degrees, 0);
  EXPECT_LT(embedding.residual, .03);
  EXPECT_LT(LimbError(embedding.joints, figure.joints), .08);
}

// To the search an elbow that is bent at will looks like the end of its arm.
TEST(EmbeddingTest, BentArmsEndAtTheHands) {
  for (const double degrees : {60, 100}) {
    const CapsuleFigure figure =
        MakeCapsuleFigure({.arm_angle_degrees = 60, .elbow_degrees = degrees});
    PLEAT_ASSERT_OK_AND_ASSIGN(const Embedding embedding, Embed(figure.mesh));
    EXPECT_EQ(embedding.arm_shortfall, 0);
    for (const int j : {kLeftLowerArm, kLeftHand, kRightLowerArm, kRightHand}) {
      EXPECT_LT((embedding.joints - figure.joints).col(j).norm(), .07)
          << degrees << ", joint " << j;
    }
  }
}

TEST(EmbeddingTest, AnArmThatEndsEarlyIsReported) {
  CapsuleFigureOptions options;
  const CapsuleFigure whole = MakeCapsuleFigure(options);
  PLEAT_ASSERT_OK_AND_ASSIGN(const Embedding with_arms, Embed(whole.mesh));
  EXPECT_EQ(with_arms.arm_shortfall, 0);
  options.arm_length = .55;
  PLEAT_ASSERT_OK_AND_ASSIGN(const Embedding stumps, Embed(MakeCapsuleFigure(options).mesh));
  EXPECT_GT(stumps.arm_shortfall, .05);
}

class FacingTest : public ::testing::TestWithParam<double> {};

TEST_P(FacingTest, LeftIsTheFiguresOwnLeft) {
  const double yaw = GetParam();
  const CapsuleFigure figure = MakeCapsuleFigure({.yaw_degrees = yaw});
  PLEAT_ASSERT_OK_AND_ASSIGN(const Embedding embedding, Embed(figure.mesh));
  EXPECT_NEAR(std::remainder(embedding.yaw_degrees - yaw, 360), 0, 15);
  EXPECT_LT(embedding.residual, .03);
  EXPECT_LT(LimbError(embedding.joints, figure.joints), .05);
}

INSTANTIATE_TEST_SUITE_P(FourAndBetween, FacingTest, ::testing::Values(0, 90, 180, 270, 40, 205));

TEST(EmbeddingTest, ScaleAndPlaceDoNotMatter) {
  const CapsuleFigure figure = MakeCapsuleFigure();
  TriangleMesh moved = figure.mesh;
  const Eigen::Vector3d offset(20, -3, 7);
  moved.positions = (40 * moved.positions).colwise() + offset;
  PLEAT_ASSERT_OK_AND_ASSIGN(const Embedding here, Embed(figure.mesh));
  PLEAT_ASSERT_OK_AND_ASSIGN(const Embedding there, Embed(moved));
  EXPECT_NEAR(there.residual, here.residual, 1e-3);
  EXPECT_LT((((there.joints.colwise() - offset) / 40) - here.joints).colwise().norm().maxCoeff(),
            .02);
}

TEST(EmbeddingTest, HoleCubeAndFlippedFacesDoNotMatter) {
  const CapsuleFigure figure = MakeCapsuleFigure();
  PLEAT_ASSERT_OK_AND_ASSIGN(const Embedding clean, Embed(figure.mesh));
  TriangleMesh dirty = figure.mesh;
  for (int f = 0; f < dirty.triangles.cols(); f += 7) {
    std::swap(dirty.triangles(0, f), dirty.triangles(1, f));
  }
  int kept = 0;  // cut off the top of the head
  for (int f = 0; f < dirty.triangles.cols(); ++f) {
    if (dirty.positions(1, dirty.triangles(0, f)) < 1.66) {
      dirty.triangles.col(kept++) = dirty.triangles.col(f);
    }
  }
  ASSERT_LT(kept, dirty.triangles.cols());
  dirty.triangles.conservativeResize(3, kept);
  dirty = JoinMeshes(dirty, MakeBox({.6, .2, -.1}, {.8, .4, .1}));  // floats beside the figure
  PLEAT_ASSERT_OK_AND_ASSIGN(const Embedding found, Embed(dirty));
  EXPECT_EQ(found.yaw_degrees, clean.yaw_degrees);
  EXPECT_LT(found.residual, .03);
  EXPECT_LT(LimbError(found.joints, figure.joints), .05);
}

TEST(EmbeddingTest, APlacedSkeletonIsStoodUprightFromAnyPosition) {
  const Eigen::Matrix3Xd joints = HumanTemplate().RestPositions();
  const Eigen::Matrix3d upright = UprightFromJoints(joints);
  EXPECT_LT((upright * upright.transpose() - Eigen::Matrix3d::Identity()).norm(), 1e-12);
  EXPECT_GT(upright.determinant(), 0);
  EXPECT_GT(upright(1, 1), .99);  // the template stands already
  for (const Eigen::Vector3d& axis :
       {Eigen::Vector3d(1, 0, 0), Eigen::Vector3d(0, 0, 1), Eigen::Vector3d(1, 2, -1)}) {
    for (const double angle : {.5, 1.5708, 3.14159}) {
      const Eigen::Matrix3d turn = Eigen::AngleAxisd(angle, axis.normalized()).toRotationMatrix();
      const Eigen::Matrix3Xd moved = (1.7 * turn * joints).colwise() + Eigen::Vector3d(3, -2, 1);
      EXPECT_LT((UprightFromJoints(moved) * turn - upright).norm(), 1e-9);
    }
  }
}

TEST(EmbeddingTest, AQuadrupedIsNoHuman) {
  const absl::StatusOr<Embedding> embedding = Embed(MakeCapsuleQuadruped());
  EXPECT_TRUE(absl::IsNotFound(embedding.status()) || embedding->residual > .15)
      << embedding->residual;
}

TEST(EmbeddingTest, AFacingMustBeGiven) {
  EmbeddingOptions options;
  options.yaws_degrees = {};
  EXPECT_THAT(Embed(MakeSphere({0, 0, 0}, 1, 12), options, 24),
              HasStatus(absl::StatusCode::kInvalidArgument, _));
}

TEST(EmbeddingTest, ABallIsNoHuman) {
  EXPECT_THAT(Embed(MakeSphere({0, 0, 0}, 1, 12), {}, 24),
              HasStatus(absl::StatusCode::kNotFound, _));
}

}  // namespace
}  // namespace pleat
