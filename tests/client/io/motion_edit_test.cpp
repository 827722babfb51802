#include "cli/io/motion_edit.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "cli/exit_code.h"
#include "pleat/math/rotations.h"
#include "support/status_matchers.h"

namespace pleat {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

const std::vector<std::string> kJoints = {"hips", "spine", "head"};

// Joint 1 turns about z by 10 degrees more in every frame; the root walks along x.
PoseTrack TurningTrack(int num_frames) {
  PoseTrack::Parts track;
  for (int t = 0; t < num_frames; ++t) {
    Pose pose;
    pose.root_position = {0.1 * t, 1, 0};
    pose.rotations.assign(3, Eigen::Quaterniond::Identity());
    pose.rotations[1] =
        Eigen::AngleAxisd(t * 10 * std::numbers::pi / 180, Eigen::Vector3d::UnitZ());
    track.poses.push_back(pose);
  }
  return PoseTrack::FromValid(std::move(track));
}

double DegreesBetween(const Eigen::Quaterniond& a, const Eigen::Quaterniond& b) {
  return a.angularDistance(b) * 180 / std::numbers::pi;
}

TEST(MotionEdit, NoEditsChangeNothing) {
  const PoseTrack track = TurningTrack(5);
  PLEAT_ASSERT_OK_AND_ASSIGN(const PoseTrack edited, EditMotion(kJoints, track, {}));
  ASSERT_EQ(edited.num_frames(), 5);
  EXPECT_EQ(edited.pose(3).rotations[1].coeffs(), track.pose(3).rotations[1].coeffs());
}

TEST(MotionEdit, ScalesAnglesPastAHalfTurn) {
  MotionEdits edits;
  edits.scale_rotation = {"spine=0.5"};
  PLEAT_ASSERT_OK_AND_ASSIGN(const PoseTrack edited, EditMotion(kJoints, TurningTrack(30), edits));
  for (int t = 0; t < 30; ++t) {
    const Eigen::Quaterniond expected(
        Eigen::AngleAxisd(t * 5 * std::numbers::pi / 180, Eigen::Vector3d::UnitZ()));
    EXPECT_NEAR(DegreesBetween(edited.pose(t).rotations[1], expected), 0, 1e-6) << t;
  }
}

TEST(MotionEdit, OffsetsTurnAboutRestAxesAfterTheMotion) {
  MotionEdits edits;
  edits.offset_rotation = {"spine=0,90,0", "head=30,0,0"};
  const PoseTrack track = TurningTrack(4);
  PLEAT_ASSERT_OK_AND_ASSIGN(const PoseTrack edited, EditMotion(kJoints, track, edits));
  const Eigen::Quaterniond quarter(
      Eigen::AngleAxisd(std::numbers::pi / 2, Eigen::Vector3d::UnitY()));
  EXPECT_NEAR(DegreesBetween(edited.pose(3).rotations[1], quarter * track.pose(3).rotations[1]), 0,
              1e-6);
  EXPECT_NEAR(DegreesBetween(edited.pose(3).rotations[2], Eigen::Quaterniond::Identity()), 30,
              1e-6);
}

TEST(MotionEdit, AllMeansEveryJointButTheRoot) {
  MotionEdits edits;
  edits.offset_rotation = {"all=0,0,10"};
  PLEAT_ASSERT_OK_AND_ASSIGN(const PoseTrack edited, EditMotion(kJoints, TurningTrack(1), edits));
  EXPECT_NEAR(DegreesBetween(edited.pose(0).rotations[0], Eigen::Quaterniond::Identity()), 0, 1e-9);
  EXPECT_NEAR(DegreesBetween(edited.pose(0).rotations[2], Eigen::Quaterniond::Identity()), 10,
              1e-6);
}

TEST(MotionEdit, SlowsDownWithinEveryClip) {
  const PoseTrack track =
      PoseTrack::FromValid({.poses = TurningTrack(6).poses(), .clip_starts = {0, 4}});
  MotionEdits edits;
  edits.time_scale = 2;
  PLEAT_ASSERT_OK_AND_ASSIGN(const PoseTrack edited, EditMotion(kJoints, track, edits));
  EXPECT_THAT(edited.clip_starts(), ElementsAre(0, 7));
  ASSERT_EQ(edited.num_frames(), 10);
  EXPECT_NEAR(edited.pose(3).root_position.x(), 0.15, 1e-12);
  EXPECT_NEAR(edited.pose(6).root_position.x(), 0.3, 1e-12);
  EXPECT_NEAR(edited.pose(7).root_position.x(), 0.4, 1e-12);
}

TEST(MotionEdit, MovesTheRoot) {
  MotionEdits edits;
  edits.offset_root = {"1,0,-2"};
  PLEAT_ASSERT_OK_AND_ASSIGN(const PoseTrack edited, EditMotion(kJoints, TurningTrack(1), edits));
  EXPECT_TRUE(edited.pose(0).root_position.isApprox(Eigen::Vector3d(1, 1, -2)));
}

TEST(MotionEdit, NamesWhatIsWrong) {
  const auto edit = [](auto member, const std::string& text) {
    MotionEdits edits;
    (edits.*member).push_back(text);
    return EditMotion(kJoints, TurningTrack(2), edits).status();
  };
  for (const absl::Status& status : {
           edit(&MotionEdits::scale_rotation, "tail=2"),
           edit(&MotionEdits::scale_rotation, "spine"),
           edit(&MotionEdits::scale_rotation, "spine=wide"),
           edit(&MotionEdits::scale_rotation, "spine=inf"),
           edit(&MotionEdits::offset_rotation, "spine=1,2"),
           edit(&MotionEdits::offset_root, "1,2,x"),
       }) {
    EXPECT_TRUE(IsUsageError(status)) << status;
  }
  EXPECT_THAT(std::string(edit(&MotionEdits::scale_rotation, "tail=2").message()),
              HasSubstr("hips, spine, head"));
  MotionEdits edits;
  edits.time_scale = 0;
  EXPECT_TRUE(IsUsageError(EditMotion(kJoints, TurningTrack(2), edits).status()));
}

TEST(MotionEdit, ParsesBoneScales) {
  PLEAT_ASSERT_OK_AND_ASSIGN(const std::vector<double> none, ParseJointFactors(kJoints, {}));
  EXPECT_THAT(none, IsEmpty());
  PLEAT_ASSERT_OK_AND_ASSIGN(const std::vector<double> some,
                             ParseJointFactors(kJoints, {"all=1.5", "head=0.5"}));
  EXPECT_THAT(some, ElementsAre(1, 1.5, 0.5));
  EXPECT_TRUE(IsUsageError(ParseJointFactors(kJoints, {"head=big"}).status()));
}

}  // namespace
}  // namespace pleat
