#include "pleat/rigging/auto_rig.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pleat/formats/sequence_reader.h"
#include "support/capsule_figure.h"
#include "support/shared_data.h"
#include "support/status_matchers.h"

namespace pleat {
namespace {

using ::testing::_;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

// The figure, `num_bad` frames of the same vertices squeezed flat before it.
MeshSequence SequenceWithBadFrames(const CapsuleFigure& figure, int num_bad, int num_good) {
  Eigen::Matrix3Xf squeezed = figure.mesh.positions.cast<float>();
  squeezed.row(1) *= .2f;
  std::vector<Eigen::Matrix3Xf> frames(num_bad, squeezed);
  frames.resize(num_bad + num_good, figure.mesh.positions.cast<float>());
  MeshSequenceOptions options;
  options.name = "figure";
  return *MeshSequence::Create(MakeTopology(figure.mesh), frames, options);
}

TEST(AutoRigTest, RigsAFigureAndSaysWhatItDid) {
  const CapsuleFigure figure = MakeCapsuleFigure({.yaw_degrees = 90});
  const MeshSequence sequence = MakeStillSequence(figure.mesh);
  AutoRigSummary summary;
  PLEAT_ASSERT_OK_AND_ASSIGN(const Rig rig, AutoRig(sequence, {}, &summary));
  EXPECT_EQ(summary.rest_frame, 0);
  EXPECT_EQ(summary.yaw_degrees, 90);
  EXPECT_LT(summary.residual, .03);
  EXPECT_EQ(summary.num_frames_tried, 1);
  EXPECT_THAT(summary.warnings, IsEmpty());
  ASSERT_EQ(rig.skeleton.num_joints(), kNumHumanJoints);
  for (int j = 0; j < kNumHumanJoints; ++j) {
    EXPECT_EQ(rig.skeleton.joint(j).name, HumanTemplate().joint(j).name);
    EXPECT_EQ(rig.skeleton.parent(j), HumanTemplate().parent(j));
  }
  EXPECT_EQ(rig.rest_positions, sequence.FrameAsDouble(0));
  EXPECT_EQ(rig.weights.num_vertices(), sequence.num_vertices());
  // Facing +x, the left is at -z.
  EXPECT_LT(rig.skeleton.rest_position(kLeftHand).z(), -.2);
  EXPECT_GT(rig.skeleton.rest_position(kRightHand).z(), .2);
}

TEST(AutoRigTest, LooksForABetterRestFrame) {
  const CapsuleFigure figure = MakeCapsuleFigure({.cell_m = .03});
  const MeshSequence sequence = SequenceWithBadFrames(figure, 3, 3);
  AutoRigSummary summary;
  ASSERT_THAT(AutoRig(sequence, {}, &summary), IsOk());
  EXPECT_EQ(summary.rest_frame, 4);  // looked at second, and good enough
  EXPECT_EQ(summary.num_frames_tried, 2);
  AutoRigOptions first;
  first.rest_frame = 0;
  EXPECT_THAT(AutoRig(sequence, first),
              HasStatus(absl::StatusCode::kFailedPrecondition, HasSubstr("another rest frame")));
}

// A figure squeezed to a third fits doubtfully and would pass with a warning; not as one frame
// among others that do not fit at all.
TEST(AutoRigTest, OneLuckyFrameIsNotEnough) {
  const CapsuleFigure figure = MakeCapsuleFigure({.cell_m = .04});
  Eigen::Matrix3Xf squat = figure.mesh.positions.cast<float>(), flat = squat;
  squat.row(1) *= .34f;
  flat.row(1) *= .15f;
  const Topology topology = MakeTopology(figure.mesh);
  AutoRigOptions options;
  options.any_orientation = false;
  AutoRigSummary summary;
  ASSERT_THAT(AutoRig(*MeshSequence::Create(topology, {squat}), options, &summary), IsOk());
  EXPECT_GT(summary.residual, .1);
  std::vector<Eigen::Matrix3Xf> frames(8, flat);
  frames[0] = squat;
  EXPECT_THAT(AutoRig(*MeshSequence::Create(topology, frames), options),
              HasStatus(absl::StatusCode::kFailedPrecondition, HasSubstr("most of the 8 frames")));
}

TEST(AutoRigTest, ThreadsDoNotChangeIt) {
  const MeshSequence sequence = MakeStillSequence(MakeCapsuleFigure({.cell_m = .03}).mesh);
  AutoRigOptions one, four;
  one.num_threads = 1;
  four.num_threads = 4;
  PLEAT_ASSERT_OK_AND_ASSIGN(const Rig a, AutoRig(sequence, one));
  PLEAT_ASSERT_OK_AND_ASSIGN(const Rig b, AutoRig(sequence, four));
  EXPECT_EQ(a.skeleton.RestPositions(), b.skeleton.RestPositions());
  EXPECT_EQ(a.weights.ToDense(), b.weights.ToDense());
}

TEST(AutoRigTest, AGivenYawIsUsed) {
  const MeshSequence sequence = MakeStillSequence(MakeCapsuleFigure({.cell_m = .03}).mesh);
  AutoRigOptions options;
  options.yaw_degrees = 180;
  options.refused_residual = 1;
  AutoRigSummary summary;
  PLEAT_ASSERT_OK_AND_ASSIGN(const Rig rig, AutoRig(sequence, options, &summary));
  EXPECT_EQ(summary.yaw_degrees, 180);
  EXPECT_LT(rig.skeleton.rest_position(kLeftHand).x(), 0);
}

TEST(AutoRigTest, RefusesAQuadrupedWithWords) {
  EXPECT_THAT(AutoRig(MakeStillSequence(MakeCapsuleQuadruped())),
              HasStatus(absl::StatusCode::kFailedPrecondition,
                        ::testing::AllOf(HasSubstr("residual"), HasSubstr("own rig"))));
}

TEST(AutoRigTest, WarnsOfAnUncleanMesh) {
  const CapsuleFigure figure = MakeCapsuleFigure({.cell_m = .03});
  const TriangleMesh mesh = JoinMeshes(figure.mesh, MakeBox({.6, .2, -.1}, {.8, .4, .1}));
  AutoRigSummary summary;
  ASSERT_THAT(AutoRig(MakeStillSequence(mesh), {}, &summary), IsOk());
  EXPECT_THAT(summary.warnings,
              ::testing::ElementsAre(HasSubstr("1 part(s)"), HasSubstr("2 components")));
}

TEST(AutoRigTest, RefusesFramesAndFacingsOutOfRange) {
  const MeshSequence sequence = MakeStillSequence(MakeBox({0, 0, 0}, {1, 1, 1}));
  AutoRigOptions options;
  options.rest_frame = 1;
  EXPECT_THAT(AutoRig(sequence, options),
              HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("rest frame 1")));
  options.rest_frame = -1;
  options.yaw_degrees = std::nan("");
  EXPECT_THAT(AutoRig(sequence, options), HasStatus(absl::StatusCode::kInvalidArgument, _));
}

TEST(AutoRigTest, CanBeCancelled) {
  const MeshSequence sequence = MakeStillSequence(MakeCapsuleFigure({.cell_m = .04}).mesh);
  const Progress cancelled({}, [] { return true; });
  EXPECT_TRUE(absl::IsCancelled(AutoRig(sequence, {}, nullptr, cancelled).status()));
}

// Captured sequences: samba faces +x, crane -x; both stand with their arms down.
absl::StatusOr<Rig> RigCaptured(const std::string& path, AutoRigSummary* summary) {
  absl::StatusOr<MeshSequence> sequence = ReadSequence(path);
  if (!sequence.ok()) return sequence.status();
  return AutoRig(*sequence, {}, summary);
}

TEST(AutoRigTest, CapturedDancerIsFoundInProfile) {
  PLEAT_SHARED_DATA_OR_SKIP(path, "samba.pc2");
  AutoRigSummary summary;
  PLEAT_ASSERT_OK_AND_ASSIGN(const Rig rig, RigCaptured(path, &summary));
  EXPECT_EQ(summary.yaw_degrees, 90);
  EXPECT_LT(summary.residual, .03);
  const Eigen::Matrix3Xd joints = rig.skeleton.RestPositions();
  EXPECT_GT(joints(0, kLeftToes), joints(0, kLeftFoot));  // toes in front
  EXPECT_LT(joints(2, kLeftHand), joints(2, kRightHand) - .4);
  EXPECT_LT(joints(2, kLeftFoot), joints(2, kRightFoot) - .05);
}

TEST(AutoRigTest, CapturedManIsFoundInProfile) {
  PLEAT_SHARED_DATA_OR_SKIP(path, "crane.pc2");
  AutoRigSummary summary;
  PLEAT_ASSERT_OK_AND_ASSIGN(const Rig rig, RigCaptured(path, &summary));
  EXPECT_EQ(summary.yaw_degrees, 270);
  EXPECT_LT(summary.residual, .03);
  const Eigen::Matrix3Xd joints = rig.skeleton.RestPositions();
  EXPECT_LT(joints(0, kLeftToes), joints(0, kLeftFoot));
  EXPECT_GT(joints(2, kLeftHand), joints(2, kRightHand) + .4);
}

TEST(AutoRigTest, CapturedHorseIsRefused) {
  PLEAT_SHARED_DATA_OR_SKIP(path, "horse_gallop.pc2");
  EXPECT_THAT(RigCaptured(path, nullptr),
              HasStatus(absl::StatusCode::kFailedPrecondition, HasSubstr("horse_gallop")));
}

}  // namespace
}  // namespace pleat
