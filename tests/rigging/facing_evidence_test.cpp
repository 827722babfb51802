#include "pleat/rigging/facing_evidence.h"

#include <gtest/gtest.h>

#include "pleat/rigging/auto_rig.h"
#include "support/capsule_figure.h"
#include "support/status_matchers.h"

namespace pleat {
namespace {

// The figure bends its left knee by up to 60 degrees; `backward` as knees do, or the other way.
MeshSequence KneeBendSequence(const CapsuleFigure& figure, bool backward) {
  const Eigen::Vector3d knee = figure.joints.col(kLeftLowerLeg);
  std::vector<Eigen::Matrix3Xf> frames;
  for (int t = 0; t < 7; ++t) {
    const Eigen::Matrix3d turn =
        Eigen::AngleAxisd((backward ? 1 : -1) * t * EIGEN_PI / 18, Eigen::Vector3d::UnitX())
            .toRotationMatrix();
    Eigen::Matrix3Xd positions = figure.mesh.positions;
    for (int v = 0; v < positions.cols(); ++v) {
      if (positions(1, v) > knee.y() || positions(0, v) < 0) continue;
      positions.col(v) = knee + turn * (positions.col(v) - knee);
    }
    frames.push_back(positions.cast<float>());
  }
  return *MeshSequence::Create(MakeTopology(figure.mesh), frames, {.name = "figure"});
}

BodyShell ShellOf(const TriangleMesh& mesh) { return {mesh.positions, mesh.triangles}; }

// The same skeleton with left and right exchanged, said to face the other way.
FacingHypothesis Opposite(const FacingHypothesis& hypothesis) {
  FacingHypothesis opposite = hypothesis;
  for (int j = 0; j < kNumHumanJoints; ++j) {
    opposite.joints.col(j) = hypothesis.joints.col(HumanMirror()[j]);
  }
  opposite.forward = -hypothesis.forward;
  return opposite;
}

TEST(FacingEvidence, FeetSayWhereTheFront) {
  const CapsuleFigure figure = MakeCapsuleFigure();
  const MeshSequence sequence = MakeStillSequence(figure.mesh);
  const FacingHypothesis hypothesis{.frame = 0, .joints = figure.joints};
  EXPECT_GT(WeighFacing(sequence, ShellOf(figure.mesh), hypothesis).feet, .5);
  EXPECT_LT(WeighFacing(sequence, ShellOf(figure.mesh), Opposite(hypothesis)).feet, -.5);
}

TEST(FacingEvidence, KneesBendOneWay) {
  const CapsuleFigure figure = MakeCapsuleFigure();
  const FacingHypothesis hypothesis{.frame = 0, .joints = figure.joints};
  EXPECT_GT(WeighFacing(KneeBendSequence(figure, true), ShellOf(figure.mesh), hypothesis).knees,
            .5);
  EXPECT_LT(
      WeighFacing(KneeBendSequence(figure, true), ShellOf(figure.mesh), Opposite(hypothesis)).knees,
      -.5);
  EXPECT_LT(WeighFacing(KneeBendSequence(figure, false), ShellOf(figure.mesh), hypothesis).knees,
            -.5);
}

TEST(FacingEvidence, FollowsAnyUp) {
  const CapsuleFigure figure = MakeCapsuleFigure();
  const Eigen::Matrix3d turn =
      Eigen::AngleAxisd(2, Eigen::Vector3d(1, -2, .5).normalized()).toRotationMatrix();
  TriangleMesh turned = figure.mesh;
  turned.positions = turn * turned.positions;
  const FacingHypothesis hypothesis{
      .frame = 0, .joints = turn * figure.joints, .forward = turn.col(2), .up = turn.col(1)};
  EXPECT_GT(WeighFacing(MakeStillSequence(turned), ShellOf(turned), hypothesis).feet, .5);
}

TEST(FacingEvidence, ABallSaysNothing) {
  const TriangleMesh ball = MakeSphere({0, .85, 0}, .8, 24);
  const FacingHypothesis hypothesis{.frame = 0, .joints = MakeCapsuleFigure({.cell_m = .1}).joints};
  EXPECT_LT(std::abs(WeighFacing(MakeStillSequence(ball), ShellOf(ball), hypothesis).total()), .4);
}

// The search is told the wrong facing alone; feet and knees put it right.
TEST(FacingEvidence, TurnsAWrongRigRound) {
  const CapsuleFigure figure = MakeCapsuleFigure({.cell_m = .03});
  AutoRigOptions options;
  options.embedding.yaws_degrees = {180};
  options.embedding.adjust_yaw = false;
  options.any_orientation = false;
  options.trusted_residual = .1;
  AutoRigSummary summary;
  PLEAT_ASSERT_OK_AND_ASSIGN(const Rig rig,
                             AutoRig(KneeBendSequence(figure, true), options, &summary));
  EXPECT_TRUE(summary.is_turned_by_evidence);
  EXPECT_NEAR(std::remainder(summary.yaw_degrees, 360), 0, 15);
  EXPECT_GT(rig.skeleton.rest_position(kLeftHand).x(), .2);
}

}  // namespace
}  // namespace pleat
