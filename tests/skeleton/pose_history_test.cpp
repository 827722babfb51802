#include "pleat/skeleton/pose_history.h"

#include <gtest/gtest.h>

#include "pleat/math/rotations.h"
#include "pleat/skeleton/human_template.h"

namespace pleat {
namespace {

// Constant velocity: frame t stands at x = t / fps and one joint has turned by t / fps radians.
PoseTrack UniformMotion(int num_frames, double fps) {
  PoseTrack::Parts track{.fps = fps};
  for (int t = 0; t < num_frames; ++t) {
    Pose pose = Pose::Rest(HumanTemplate());
    pose.root_position.x() = t / fps;
    pose.rotations[kHead] = QuaternionFromExponentialMap({0, t / fps, 0});
    track.poses.push_back(pose);
  }
  return PoseTrack::FromValid(std::move(track));
}

double Turn(const Pose& pose) { return ExponentialMapFromQuaternion(pose.rotations[kHead]).y(); }

TEST(PoseHistoryTest, SameRateGivesThePosesThemselves) {
  const PoseTrack track = UniformMotion(10, 30);
  PoseHistory history(track, 30, 3);
  std::vector<const Pose*> poses;
  history.At(5, &poses);
  ASSERT_EQ(poses.size(), 3u);
  EXPECT_EQ(poses[0], &track.pose(5));
  EXPECT_EQ(poses[1], &track.pose(4));
  EXPECT_EQ(poses[2], &track.pose(3));
}

TEST(PoseHistoryTest, IntervalsAreThoseOfTheModelAtAnyRate) {
  for (const double fps : {24.0, 60.0, 50.0}) {
    const PoseTrack track = UniformMotion(60, fps);
    PoseHistory history(track, 30, 2);
    std::vector<const Pose*> poses;
    history.At(40, &poses);
    EXPECT_NEAR(poses[0]->root_position.x() - poses[1]->root_position.x(), 1 / 30.0, 1e-9) << fps;
    EXPECT_NEAR(Turn(*poses[0]) - Turn(*poses[1]), 1 / 30.0, 1e-9) << fps;
  }
}

TEST(PoseHistoryTest, TheFirstFrameContinuesItsMotionBackwards) {
  const PoseTrack track = UniformMotion(10, 30);
  PoseHistory history(track, 30, 2);
  std::vector<const Pose*> poses;
  history.At(0, &poses);
  EXPECT_NEAR(poses[1]->root_position.x(), -1 / 30.0, 1e-9);
  EXPECT_NEAR(Turn(*poses[1]), -1 / 30.0, 1e-9);
}

TEST(PoseHistoryTest, ClipsAreSeparate) {
  PoseTrack::Parts parts = UniformMotion(10, 30).Take();
  parts.clip_starts = {0, 4, 9};
  for (int t = 4; t < 10; ++t) parts.poses[t].root_position.x() += 100;
  const PoseTrack track = PoseTrack::FromValid(std::move(parts));
  PoseHistory history(track, 30, 2);
  std::vector<const Pose*> poses;
  history.At(4, &poses);
  EXPECT_NEAR(poses[1]->root_position.x(), 100 + 3 / 30.0, 1e-9);
  history.At(9, &poses);  // a clip of one frame stands still
  EXPECT_EQ(poses[1]->root_position, track.pose(9).root_position);
}

TEST(PoseHistoryTest, SamplePoseInterpolates) {
  const PoseTrack track = UniformMotion(10, 10);
  const Pose pose = SamplePose(track, 0, 10, 2.25);
  EXPECT_NEAR(pose.root_position.x(), 0.225, 1e-12);
  EXPECT_NEAR(Turn(pose), 0.225, 1e-9);
  EXPECT_EQ(SamplePose(track, 0, 10, 99).root_position, track.pose(9).root_position);
}

}  // namespace
}  // namespace pleat
