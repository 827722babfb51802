#include "pleat/rigging/heat_weights.h"

#include <gtest/gtest.h>

#include "support/capsule_figure.h"
#include "support/status_matchers.h"

namespace pleat {
namespace {

using ::testing::HasSubstr;

Skeleton FigureSkeleton(const CapsuleFigure& figure) {
  return HumanTemplate().WithRestPositions(figure.joints);
}

TEST(HeatWeightsTest, VerticesAroundTheMiddleOfABoneFollowIt) {
  const CapsuleFigure figure = MakeCapsuleFigure();
  HeatWeightsSummary summary;
  PLEAT_ASSERT_OK_AND_ASSIGN(const SkinWeights weights,
                             ComputeHeatWeights(MakeTopology(figure.mesh), figure.mesh.positions,
                                                FigureSkeleton(figure), {}, &summary));
  EXPECT_EQ(summary.num_cold_components, 0);
  EXPECT_LT(summary.num_hidden_vertices, weights.num_vertices() / 50);
  const Eigen::MatrixXd dense = weights.ToDense();
  for (int v = 0; v < dense.rows(); ++v) ASSERT_NEAR(dense.row(v).sum(), 1, 1e-5);
  for (int b : {kHead, kLeftLowerLeg, kRightFoot, kLeftLowerArm, kRightLowerArm, kLeftHand}) {
    const Eigen::Vector3d middle =
        .5 * (figure.joints.col(b) + figure.joints.col(HumanTemplate().parent(b)));
    int num_near = 0;
    for (int v = 0; v < dense.rows(); ++v) {
      if ((figure.mesh.positions.col(v) - middle).norm() > .095) continue;
      ++num_near;
      EXPECT_GT(dense(v, b), .5) << HumanTemplate().joint(b).name;
    }
    EXPECT_GT(num_near, 3) << HumanTemplate().joint(b).name;
  }
}

TEST(HeatWeightsTest, MirroredBonesGetMirroredWeights) {
  // Symmetric sampling: a box around two bones, mirrored in x = 0.
  const Skeleton skeleton = *Skeleton::Create(
      {{"root", -1, {0, .5, 0}}, {"left", 0, {1.5, .5, 0}}, {"right", 0, {-1.5, .5, 0}}});
  const TriangleMesh mesh = MakeCapsuleBody({{{-1.5, .5, 0}, {1.5, .5, 0}, .3, .3}}, .1);
  PLEAT_ASSERT_OK_AND_ASSIGN(const SkinWeights weights,
                             ComputeHeatWeights(MakeTopology(mesh), mesh.positions, skeleton));
  const Eigen::MatrixXd dense = weights.ToDense();
  double left = 0, right = 0;
  for (int v = 0; v < dense.rows(); ++v) {
    const double x = mesh.positions(0, v);
    if (x > .5) {
      EXPECT_GT(dense(v, 1), .9);
    } else if (x < -.5) {
      EXPECT_GT(dense(v, 2), .9);
    } else if (std::abs(x) < .05) {
      EXPECT_NEAR(dense(v, 1), .5, .25);
    }
    left += dense(v, 1);
    right += dense(v, 2);
  }
  EXPECT_NEAR(left / right, 1, .02);
}

TEST(HeatWeightsTest, ScaleAndUnitDoNotMatter) {
  const CapsuleFigure figure = MakeCapsuleFigure({.cell_m = .04});
  const Topology topology = MakeTopology(figure.mesh);
  PLEAT_ASSERT_OK_AND_ASSIGN(
      const SkinWeights meters,
      ComputeHeatWeights(topology, figure.mesh.positions, FigureSkeleton(figure)));
  PLEAT_ASSERT_OK_AND_ASSIGN(
      const SkinWeights centimeters,
      ComputeHeatWeights(topology, 100 * figure.mesh.positions,
                         HumanTemplate().WithRestPositions(100 * figure.joints)));
  EXPECT_LT((meters.ToDense() - centimeters.ToDense()).cwiseAbs().maxCoeff(), 1e-4);
}

TEST(HeatWeightsTest, ColdComponentsAndLooseVerticesFollowTheirNearestBone) {
  const CapsuleFigure figure = MakeCapsuleFigure({.cell_m = .04});
  const Eigen::Vector3d beside = figure.joints.col(kLeftHand) + Eigen::Vector3d(.3, -.2, 0);
  TriangleMesh mesh =
      JoinMeshes(figure.mesh, MakeBox(beside.array() - .05, Eigen::Vector3d(beside.array() + .05)));
  mesh.positions.conservativeResize(3, mesh.positions.cols() + 1);
  mesh.positions.rightCols(1) = figure.joints.col(kHead) + Eigen::Vector3d(0, .4, 0);
  HeatWeightsSummary summary;
  PLEAT_ASSERT_OK_AND_ASSIGN(
      const SkinWeights weights,
      ComputeHeatWeights(MakeTopology(mesh), mesh.positions, FigureSkeleton(figure), {}, &summary));
  EXPECT_EQ(summary.num_cold_components, 1);
  const int num_vertices = weights.num_vertices();
  EXPECT_EQ(weights.vertex(num_vertices - 1).bones[0], kHead);
  for (int v = num_vertices - 9; v < num_vertices - 1; ++v) {
    EXPECT_EQ(weights.vertex(v).bones[0], kLeftHand);
  }
}

TEST(HeatWeightsTest, ThreadsDoNotChangeThem) {
  const CapsuleFigure figure = MakeCapsuleFigure({.cell_m = .04});
  const Topology topology = MakeTopology(figure.mesh);
  const auto solve = [&](int num_threads) {
    HeatWeightsOptions options;
    options.num_threads = num_threads;
    return ComputeHeatWeights(topology, figure.mesh.positions, FigureSkeleton(figure), options)
        ->ToDense();
  };
  EXPECT_EQ(solve(1), solve(4));
}

TEST(HeatWeightsTest, RefusesASkeletonWithoutBone) {
  const TriangleMesh mesh = MakeBox({0, 0, 0}, {1, 1, 1});
  const Skeleton point = *Skeleton::Create({{"root", -1, {0, 0, 0}}});
  EXPECT_THAT(ComputeHeatWeights(MakeTopology(mesh), mesh.positions, point),
              HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("need a bone")));
}

}  // namespace
}  // namespace pleat
