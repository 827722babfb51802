// Stand-ins for captures of other kinds: made from the generated performer, whose joints are known,
// and from the figure of capsules.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "pleat/base/random.h"
#include "pleat/performer/performer.h"
#include "pleat/rigging/auto_rig.h"
#include "support/capsule_figure.h"
#include "support/status_matchers.h"

namespace pleat {
namespace {

const Performer& Dancer() {
  static const Performer& performer =
      *new Performer(*GeneratePerformer({.num_frames = 48, .num_vertices = 4000}));
  return performer;
}

MeshSequence WithFrames(const Topology& topology, std::vector<Eigen::Matrix3Xf> frames) {
  return *MeshSequence::Create(topology, std::move(frames), {.name = "stand-in"});
}

std::vector<Eigen::Matrix3Xf> FramesOf(const MeshSequence& sequence) {
  std::vector<Eigen::Matrix3Xf> frames;
  for (int t = 0; t < sequence.num_frames(); ++t) frames.push_back(sequence.frame(t));
  return frames;
}

// Mean distance of hips, legs and arms from the truth in the rig's rest frame, share of the height;
// the template's spine, chest and head are no anatomical points.
double LimbError(const Rig& rig, const PerformerTruth& truth, int frame) {
  BoneTransforms transforms;
  ComputeBoneTransforms(truth.rig.skeleton, truth.track.pose(frame), {}, &transforms);
  double sum = 0;
  int count = 0;
  for (int j = 0; j < kNumHumanJoints; ++j) {
    if (j == kSpine || j == kChest || j == kHead) continue;
    sum += (rig.skeleton.rest_position(j) - transforms.joint_positions.col(j)).norm();
    ++count;
  }
  return sum / count / 1.7;
}

TEST(CaptureLikes, ThePerformersJointsAreFound) {
  AutoRigSummary summary;
  PLEAT_ASSERT_OK_AND_ASSIGN(const Rig rig, AutoRig(Dancer().sequence, {}, &summary));
  EXPECT_LT(LimbError(rig, Dancer().truth, summary.rest_frame), .03);
}

// Decoded from a lossy stream: every frame has its own noise.
TEST(CaptureLikes, NoisyFrames) {
  std::vector<Eigen::Matrix3Xf> frames = FramesOf(Dancer().sequence);
  Random random(3);
  for (Eigen::Matrix3Xf& frame : frames) {
    for (Eigen::Index i = 0; i < frame.size(); ++i) {
      frame(i) += static_cast<float>(.002 * random.Normal());
    }
  }
  AutoRigSummary summary;
  PLEAT_ASSERT_OK_AND_ASSIGN(
      const Rig rig, AutoRig(WithFrames(Dancer().sequence.topology(), frames), {}, &summary));
  EXPECT_LT(LimbError(rig, Dancer().truth, summary.rest_frame), .03);
}

// Every third frame only, and half a meter of leap between them.
TEST(CaptureLikes, FastJumps) {
  std::vector<Eigen::Matrix3Xf> frames;
  for (int t = 0; t < Dancer().sequence.num_frames(); t += 3) {
    frames.push_back(Dancer().sequence.frame(t));
    frames.back().row(1).array() += t % 2 == 0 ? .5f : 0.f;
    frames.back().row(0).array() += .2f * static_cast<float>(t);
  }
  AutoRigSummary summary;
  PLEAT_ASSERT_OK_AND_ASSIGN(
      const Rig rig, AutoRig(WithFrames(Dancer().sequence.topology(), frames), {}, &summary));
  EXPECT_LT(summary.residual, .03);
  EXPECT_GT(summary.evidence.total(), .5);
}

// Starts in the middle of the dance: another rest frame, the same sides.
TEST(CaptureLikes, AnyFirstFrame) {
  for (const int first : {12, 30}) {
    std::vector<int> rest(Dancer().sequence.num_frames() - first);
    for (size_t k = 0; k < rest.size(); ++k) rest[k] = first + static_cast<int>(k);
    AutoRigSummary summary;
    PLEAT_ASSERT_OK_AND_ASSIGN(const Rig rig,
                               AutoRig(Dancer().sequence.Subset(rest), {}, &summary));
    EXPECT_LT(LimbError(rig, Dancer().truth, first + summary.rest_frame), .05) << first;
  }
}

// Cut into open pieces at neck, wrists, ankles and the waist: eight components.
TEST(CaptureLikes, OpenPieces) {
  const Eigen::Matrix3Xd rest = Dancer().sequence.FrameAsDouble(0);
  const Topology& whole = Dancer().sequence.topology();
  const Skeleton& skeleton = Dancer().truth.rig.skeleton;
  const auto is_cut = [&](const Eigen::Vector3d& center) {
    for (const auto& [from, to, share] : {std::tuple{kChest, kHead, .55},
                                          {kLeftLowerArm, kLeftHand, .85},
                                          {kRightLowerArm, kRightHand, .85},
                                          {kLeftLowerLeg, kLeftFoot, .8},
                                          {kRightLowerLeg, kRightFoot, .8},
                                          {kHips, kChest, .6}}) {
      const Eigen::Vector3d a = skeleton.rest_position(from), b = skeleton.rest_position(to);
      const Eigen::Vector3d at = a + share * (b - a), axis = (b - a).normalized();
      if ((center - at).norm() < .2 && std::abs(axis.dot(center - at)) < .01) return true;
    }
    return false;
  };
  std::vector<Eigen::Vector3i> kept;
  for (int f = 0; f < whole.num_triangles(); ++f) {
    const Eigen::Vector3i t = whole.triangles().col(f);
    if (!is_cut((rest.col(t[0]) + rest.col(t[1]) + rest.col(t[2])) / 3)) kept.push_back(t);
  }
  Eigen::Matrix3Xi triangles(3, kept.size());
  for (size_t f = 0; f < kept.size(); ++f) triangles.col(static_cast<Eigen::Index>(f)) = kept[f];
  AutoRigSummary summary;
  PLEAT_ASSERT_OK_AND_ASSIGN(
      const Rig rig, AutoRig(WithFrames(*Topology::FromTriangles(whole.num_vertices(), triangles),
                                        FramesOf(Dancer().sequence)),
                             {}, &summary));
  EXPECT_GT(summary.surface.num_components, 4);
  EXPECT_GT(summary.surface.num_boundary_edges, 50);
  EXPECT_LT(LimbError(rig, Dancer().truth, summary.rest_frame), .03);
}

// A strap from the left hand to the hip makes a ring: the arm must not become part of it.
TEST(CaptureLikes, AHandleAtTheHip) {
  const CapsuleFigure figure = MakeCapsuleFigure();
  TriangleMesh ring =
      MakeCapsuleBody({{figure.joints.col(kLeftHand),
                        figure.joints.col(kLeftUpperLeg) + Eigen::Vector3d(.08, .1, 0), .02, .02}},
                      .01);
  PLEAT_ASSERT_OK_AND_ASSIGN(const Rig plain, AutoRig(MakeStillSequence(figure.mesh)));
  AutoRigSummary summary;
  const absl::StatusOr<Rig> rig =
      AutoRig(MakeStillSequence(JoinMeshes(figure.mesh, ring)), {}, &summary);
  ASSERT_THAT(rig, IsOk());
  const Eigen::RowVectorXd errors =
      (rig->skeleton.RestPositions() - plain.skeleton.RestPositions()).colwise().norm() / 1.7;
  EXPECT_LT(errors.mean(), .03) << errors;
}

}  // namespace
}  // namespace pleat
