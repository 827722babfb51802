// Bodies that are not one clean closed surface: pieces, crumbs, inner walls, soup; turned; fat. The
// skeleton must be that of the figure.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <ostream>
#include <string>

#include "pleat/rigging/auto_rig.h"
#include "rigging/test_bodies.h"
#include "support/capsule_figure.h"
#include "support/status_matchers.h"

namespace pleat {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;

// Mean distance of the joints of arms and legs, as a share of the height.
double RelativeLimbError(const Eigen::Matrix3Xd& joints, const Eigen::Matrix3Xd& truth) {
  return (joints - truth).rightCols(kNumHumanJoints - kLeftUpperLeg).colwise().norm().mean() /
         kHeight;
}

// Every part of the figure as a closed surface of its own.
TriangleMesh InPieces(const CapsuleFigureOptions& options, double cell = .02) {
  TriangleMesh pieces{Eigen::Matrix3Xd(3, 0), Eigen::Matrix3Xi(3, 0)};
  for (const Capsule& part : CapsuleFigureParts(options)) {
    pieces = JoinMeshes(pieces, MakeCapsuleBody({part}, cell));
  }
  return pieces;
}

// Every triangle by itself and a little smaller: there is a slit along every edge.
TriangleMesh AsSoup(const TriangleMesh& mesh) {
  TriangleMesh soup{Eigen::Matrix3Xd(3, 3 * mesh.triangles.cols()), mesh.triangles};
  for (int f = 0; f < mesh.triangles.cols(); ++f) {
    const Eigen::Matrix3d corners = mesh.positions(Eigen::all, mesh.triangles.col(f));
    const Eigen::Vector3d center = corners.rowwise().mean();
    soup.positions.middleCols<3>(3 * f) = (.98 * corners).colwise() + .02 * center;
    soup.triangles.col(f) << 3 * f, 3 * f + 1, 3 * f + 2;
  }
  return soup;
}

struct Unclean {
  std::string name;
  CapsuleFigureOptions figure;
  std::function<TriangleMesh(const CapsuleFigureOptions&)> make;
  double most_error = .035, most_residual = .03;
};

void PrintTo(const Unclean& unclean, std::ostream* out) { *out << unclean.name; }

class UncleanBodyTest : public ::testing::TestWithParam<Unclean> {};

TEST_P(UncleanBodyTest, HasTheSkeletonOfTheFigure) {
  const Unclean& unclean = GetParam();
  const TriangleMesh mesh = unclean.make(unclean.figure);
  AutoRigSummary summary;
  PLEAT_ASSERT_OK_AND_ASSIGN(const Rig rig, AutoRig(MakeStillSequence(mesh), {}, &summary));
  const Eigen::Matrix3Xd truth = MakeCapsuleFigure(unclean.figure).joints;
  const Eigen::Matrix3Xd joints = rig.skeleton.RestPositions();
  EXPECT_LT(RelativeLimbError(joints, truth), unclean.most_error) << (joints - truth) / kHeight;
  EXPECT_LT(summary.residual, unclean.most_residual);
  EXPECT_EQ(rig.weights.num_vertices(), mesh.positions.cols());
}

INSTANTIATE_TEST_SUITE_P(
    Figures, UncleanBodyTest,
    ::testing::Values(
        Unclean{"Pieces", {}, [](const auto& figure) { return InPieces(figure); }},
        Unclean{"PiecesInTPose",
                {.arm_angle_degrees = 2},
                [](const auto& figure) { return InPieces(figure); },
                .035,
                .04},
        Unclean{"PiecesFromBehind",
                {.yaw_degrees = 180, .arm_angle_degrees = 70},
                [](const auto& figure) { return InPieces(figure); }},
        Unclean{"PiecesAcrossTheFacings",
                {.yaw_degrees = 135},
                [](const auto& figure) { return InPieces(figure); }},
        Unclean{"PiecesAndCrumbs",
                {},
                [](const auto& figure) {
                  return JoinMeshes(
                      JoinMeshes(InPieces(figure), MakeBox({.8, .2, 0}, {.85, .25, .05})),
                      MakeBox({60, 2, 0}, {60.01, 2.01, .01}));
                }},
        Unclean{"InnerWalls",
                {},
                [](const auto& figure) {
                  return JoinMeshes(MakeCapsuleFigure(figure).mesh,
                                    JoinMeshes(MakeBox({-.1, 1.2, -.05}, {.1, 1.21, .05}),
                                               MakeBox({-.08, .95, -.06}, {.08, 1.3, -.05})));
                }},
        Unclean{
            "Soup", {}, [](const auto& figure) { return AsSoup(MakeCapsuleFigure(figure).mesh); }},
        Unclean{"ShortLegs",
                {.leg_length = .6, .girth = 1.3},
                [](const auto& figure) { return MakeCapsuleFigure(figure).mesh; }},
        Unclean{"ShortLegsUnderABelly",
                {.leg_length = .4, .girth = 1.4, .cell_m = .028},
                [](const auto& figure) { return MakeCapsuleFigure(figure).mesh; }},
        Unclean{"LargeHead",
                {.arm_angle_degrees = 35, .leg_length = .6, .head = 2.5, .cell_m = .028},
                [](const auto& figure) { return MakeCapsuleFigure(figure).mesh; }},
        Unclean{"SpreadFingersInTPose",
                {.arm_angle_degrees = 2, .fingers = true},
                [](const auto& figure) { return MakeCapsuleFigure(figure).mesh; },
                .035,
                .04}),
    [](const auto& instance) { return instance.param.name; });

TEST(UncleanBodies, StrayPartsAreNamedWithTheirVertices) {
  const TriangleMesh mesh =
      JoinMeshes(MakeCapsuleFigure({.cell_m = .03}).mesh, MakeBox({5, 0, 0}, {5.017, .017, .017}));
  AutoRigSummary summary;
  PLEAT_ASSERT_OK_AND_ASSIGN(const Rig rig, AutoRig(MakeStillSequence(mesh), {}, &summary));
  EXPECT_EQ(summary.stray_parts, std::vector<int>{8});
  EXPECT_THAT(summary.warnings, Contains(HasSubstr("1 part(s) float")));
  EXPECT_EQ(rig.weights.num_vertices(), mesh.positions.cols());
}

class OrientationTest : public ::testing::TestWithParam<std::pair<Eigen::Vector3d, double>> {};

TEST_P(OrientationTest, GivesTheSameSkeletonTurned) {
  const Eigen::Matrix3d turn = TurnAbout(GetParam().first, GetParam().second);
  TriangleMesh mesh = MakeCapsuleFigure({.arm_angle_degrees = 25, .cell_m = .03}).mesh;
  PLEAT_ASSERT_OK_AND_ASSIGN(const Rig upright, AutoRig(MakeStillSequence(mesh)));
  mesh.positions = turn * mesh.positions;
  PLEAT_ASSERT_OK_AND_ASSIGN(const Rig turned, AutoRig(MakeStillSequence(mesh)));
  const Eigen::Matrix3Xd off =
      turn.transpose() * turned.skeleton.RestPositions() - upright.skeleton.RestPositions();
  EXPECT_LT(off.colwise().norm().mean() / kHeight, .015);
}

INSTANTIATE_TEST_SUITE_P(Turns, OrientationTest,
                         ::testing::Values(std::pair(Eigen::Vector3d(1, 0, 0), 90.),
                                           std::pair(Eigen::Vector3d(1, 0, 0), -90.),
                                           std::pair(Eigen::Vector3d(0, 0, 1), 180.),
                                           std::pair(Eigen::Vector3d(0, 1, 0), 45.),
                                           std::pair(Eigen::Vector3d(1, 1, 0), 90.),
                                           std::pair(Eigen::Vector3d(1, -2, 3), 245.)));

// Two joints that a person clicks, and the rest is solved; nothing is refused then.
TEST(UncleanBodies, PlacedJointsStayAndHelp) {
  const CapsuleFigure figure = MakeCapsuleFigure({.cell_m = .03});
  AutoRigOptions options;
  const Eigen::Vector3d hand = figure.joints.col(kLeftHand) + Eigen::Vector3d(.02, 0, .01);
  options.placed_joints = {{kLeftHand, hand}, {kRightLowerLeg, figure.joints.col(kRightLowerLeg)}};
  PLEAT_ASSERT_OK_AND_ASSIGN(const Rig rig, AutoRig(MakeStillSequence(figure.mesh), options));
  EXPECT_LT((rig.skeleton.rest_position(kLeftHand) - hand).norm(), 1e-9);
  EXPECT_LT((rig.skeleton.RestPositions() - figure.joints).col(kRightLowerLeg).norm(), 1e-9);
  EXPECT_LT(RelativeLimbError(rig.skeleton.RestPositions(), figure.joints), .035);

  const TriangleMesh beast = MakeCapsuleQuadruped(.05);
  options.placed_joints = {{kHead, {0, 1.6, 1.2}}};
  PLEAT_ASSERT_OK_AND_ASSIGN(const Rig beast_rig, AutoRig(MakeStillSequence(beast), options));
  EXPECT_LT((beast_rig.skeleton.rest_position(kHead) - Eigen::Vector3d(0, 1.6, 1.2)).norm(), 1e-9);
  options.placed_joints[0].joint = kNumHumanJoints;
  EXPECT_TRUE(absl::IsInvalidArgument(AutoRig(MakeStillSequence(beast), options).status()));
}

}  // namespace
}  // namespace pleat
