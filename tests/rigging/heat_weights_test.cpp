#include "pleat/rigging/heat_weights.h"

#include <gtest/gtest.h>

#include <algorithm>

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

// A straight tube around a chain of three bones along x.
struct Tube {
  TriangleMesh mesh = MakeCapsuleBody({{{0, 0, 0}, {3, 0, 0}, .2, .2}}, .08);
  Skeleton skeleton = Skeleton::Create({{"root", -1, {0, 0, 0}},
                                        {"first", 0, {1, 0, 0}},
                                        {"second", 1, {2, 0, 0}},
                                        {"third", 2, {3, 0, 0}}})
                          .value();
  Eigen::MatrixXd Weights(const HeatWeightsOptions& options = {}) const {
    return ComputeHeatWeights(MakeTopology(mesh), mesh.positions, skeleton, options)->ToDense();
  }
};

TEST(HeatWeightsTest, AlongATubeEveryBoneRisesAndFalls) {
  const Tube tube;
  const Eigen::MatrixXd dense = tube.Weights();
  // Mean weights of slices across the tube.
  constexpr int kNumSlices = 30;
  Eigen::MatrixXd slices = Eigen::MatrixXd::Zero(kNumSlices, 4);
  Eigen::VectorXd counts = Eigen::VectorXd::Zero(kNumSlices);
  for (int v = 0; v < dense.rows(); ++v) {
    const int slice = std::clamp(static_cast<int>(10 * tube.mesh.positions(0, v)), 0, 29);
    slices.row(slice) += dense.row(v);
    counts[slice] += 1;
  }
  for (int s = 0; s < kNumSlices; ++s) slices.row(s) /= counts[s];
  for (int s = 1; s < kNumSlices; ++s) {
    EXPECT_LT(slices(s, 1), slices(s - 1, 1) + .02) << s;  // only falls
    EXPECT_GT(slices(s, 3), slices(s - 1, 3) - .02) << s;  // only rises
    // From the other end it looks the same.
    EXPECT_NEAR(slices(s, 1), slices(kNumSlices - 1 - s, 3), .08) << s;
    EXPECT_NEAR(slices(s, 2), slices(kNumSlices - 1 - s, 2), .08) << s;
  }
  EXPECT_GT(slices(3, 1), .95);
  EXPECT_GT(slices(15, 2), .9);
  EXPECT_LT(slices(3, 3), .01);
}

TEST(HeatWeightsTest, MoreHeatMakesSharperTransitions) {
  const Tube tube;
  double last = 0;
  for (const double heat_constant : {.1, 1.0, 10.0}) {
    const Eigen::MatrixXd dense = tube.Weights({.heat_constant = heat_constant});
    // Nearness to weights of 0 and 1.
    const double sharpness = dense.array().square().rowwise().sum().mean();
    EXPECT_GT(sharpness, last) << heat_constant;
    last = sharpness;
  }
  EXPECT_LE(last, 1 + 1e-6);
}

// Heat has no sources between the bones: no weight leaves [0, 1], and all of them together are 1.
TEST(HeatWeightsTest, TheEquilibriumItselfIsAPartitionOfOne) {
  const CapsuleFigure figure = MakeCapsuleFigure({.cell_m = .04});
  const Skeleton skeleton = FigureSkeleton(figure);
  PLEAT_ASSERT_OK_AND_ASSIGN(const SolidSurface surface,
                             PrepareSolidSurface(MakeTopology(figure.mesh), figure.mesh.positions));
  const TriangleTree tree(surface.positions, surface.triangles);
  const WindingNumber winding_number(tree);
  PLEAT_ASSERT_OK_AND_ASSIGN(
      const Eigen::MatrixXd weights,
      SolveHeatEquilibrium(surface, {&tree, &winding_number, nullptr}, skeleton, figure.joints));
  ASSERT_EQ(weights.rows(), surface.positions.cols());
  ASSERT_EQ(weights.cols(), kNumHumanJoints);
  EXPECT_EQ(weights.col(0).cwiseAbs().maxCoeff(), 0);
  EXPECT_LT((weights.rowwise().sum().array() - 1).abs().maxCoeff(), 1e-6);
  EXPECT_GT(weights.minCoeff(), -.02);  // obtuse triangles conduct backwards a little
  EXPECT_LT(weights.maxCoeff(), 1.02);
  PLEAT_ASSERT_OK_AND_ASSIGN(
      const SkinWeights cut,
      WeightsOfInput(surface, weights, figure.mesh.positions, skeleton, figure.joints));
  EXPECT_EQ(cut.num_vertices(), figure.mesh.positions.cols());
  const Progress cancelled({}, [] { return true; });
  EXPECT_TRUE(
      absl::IsCancelled(SolveHeatEquilibrium(surface, {&tree, &winding_number, nullptr}, skeleton,
                                             figure.joints, {}, nullptr, cancelled)
                            .status()));
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
  const Skeleton stick = *Skeleton::Create({{"root", -1, {0, 0, 0}}, {"tip", 0, {0, 1, 0}}});
  EXPECT_THAT(ComputeHeatWeights(MakeTopology(mesh), 0 * mesh.positions, stick),
              HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("area")));
}

// Heat reaches everywhere; a hundredth is where painted weights begin.
TEST(HeatWeightsTest, HaveNoTails) {
  const CapsuleFigure figure = MakeCapsuleFigure({.cell_m = .03});
  PLEAT_ASSERT_OK_AND_ASSIGN(
      const SkinWeights weights,
      ComputeHeatWeights(MakeTopology(figure.mesh), figure.mesh.positions, FigureSkeleton(figure)));
  const Eigen::MatrixXd dense = weights.ToDense();
  int num_shared = 0;
  for (int v = 0; v < dense.rows(); ++v) {
    EXPECT_NEAR(dense.row(v).sum(), 1, 1e-6);
    for (const double weight : dense.row(v)) EXPECT_TRUE(weight == 0 || weight > .009) << weight;
    num_shared += (dense.row(v).array() > 0).count() > 1 ? 1 : 0;
  }
  EXPECT_GT(num_shared, dense.rows() / 10);
}

TEST(HeatWeightsTest, AreCarriedFromAShell) {
  const TriangleMesh box = MakeBox({0, 0, 0}, {1, 1, 1});
  const BodyShell shell{box.positions, box.triangles};
  Eigen::MatrixXd weights = Eigen::MatrixXd::Zero(8, 3);
  weights.col(1) = box.positions.row(0).transpose();
  weights.col(2) = (1 - box.positions.row(0).array()).transpose();
  Eigen::Matrix3Xd points(3, 3);
  points << .25, 1.5, .995, .5, .5, .5, 1.2, .5, 1.1;
  PLEAT_ASSERT_OK_AND_ASSIGN(
      const SkinWeights carried,
      WeightsFromShell(shell, TriangleTree(shell.positions, shell.triangles), weights, points, 1));
  const Eigen::MatrixXd dense = carried.ToDense();
  EXPECT_NEAR(dense(0, 1), .25, 1e-6);
  EXPECT_NEAR(dense(0, 2), .75, 1e-6);
  EXPECT_NEAR(dense(1, 1), 1, 1e-6);
  EXPECT_EQ(dense(2, 2), 0);  // .005 is a tail
}

}  // namespace
}  // namespace pleat
