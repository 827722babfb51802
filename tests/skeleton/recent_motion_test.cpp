#include "pleat/skeleton/recent_motion.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "pleat/skeleton/pose_history.h"
#include "support/not_a_number.h"
#include "support/status_matchers.h"

namespace pleat {
namespace {

using ::testing::HasSubstr;

constexpr double kInterval = .04;  // seconds: 25 frames per second
constexpr int kDepth = 4;

// A root that moves as its time goes, and one joint that turns at a constant speed.
Pose PoseAtTime(double seconds) {
  return {
      .root_position = {seconds, 0, 0},
      .rotations = {Eigen::Quaterniond::Identity(),
                    Eigen::Quaterniond(Eigen::AngleAxisd(.5 * seconds, Eigen::Vector3d::UnitY()))}};
}

std::vector<const Pose*> HistoryOf(RecentMotion& motion) {
  std::vector<const Pose*> poses;
  motion.History(&poses);
  return poses;
}

TEST(RecentMotionTest, AnyFrameRateGivesThePosesOfTheIntervals) {
  for (const double fps : {7., 24., 25., 60., 144., 5000.}) {
    RecentMotion motion(2, kInterval, kDepth);
    double now = 0;
    for (int i = 0; now < 102; ++i) {
      now = 100 + i / fps;  // the seconds count from anywhere
      ASSERT_THAT(motion.Add(now, PoseAtTime(now)), IsOk());
    }
    const std::vector<const Pose*> poses = HistoryOf(motion);
    ASSERT_EQ(poses.size(), 4u);
    for (int h = 0; h < kDepth; ++h) {
      const Pose expected = PoseAtTime(now - h * kInterval);
      EXPECT_NEAR(poses[h]->root_position.x(), expected.root_position.x(), 1e-9) << fps;
      EXPECT_LT(poses[h]->rotations[1].angularDistance(expected.rotations[1]), 1e-7) << fps;
    }
  }
}

TEST(RecentMotionTest, VaryingTimesAreNoMatterToAConstantSpeed) {
  RecentMotion motion(2, kInterval, kDepth);
  double now = 0;
  for (int i = 0; i < 300; ++i) {
    now += .001 + .02 * std::abs(std::sin(1.7 * i));
    ASSERT_THAT(motion.Add(now, PoseAtTime(now)), IsOk());
  }
  const std::vector<const Pose*> poses = HistoryOf(motion);
  for (int h = 0; h < kDepth; ++h) {
    EXPECT_NEAR(poses[h]->root_position.x(), now - h * kInterval, 1e-9);
  }
}

// At the frame rate of the model the history is that of a track, bit for bit.
TEST(RecentMotionTest, AtTheRateOfTheModelItIsTheHistoryOfATrack) {
  PoseTrack::Parts parts{.fps = 25};
  for (int t = 0; t < 30; ++t) parts.poses.push_back(PoseAtTime(std::sin(.3 * t)));
  const PoseTrack track = PoseTrack::FromValid(std::move(parts));
  PoseHistory of_track(track, 25, kDepth);
  RecentMotion motion(2, kInterval, kDepth);
  std::vector<const Pose*> expected;
  for (int t = 0; t < track.num_frames(); ++t) {
    ASSERT_THAT(motion.Add(t / 25.0, track.pose(t)), IsOk());
    if (t < kDepth) continue;
    of_track.At(t, &expected);
    const std::vector<const Pose*> poses = HistoryOf(motion);
    for (int h = 0; h < kDepth; ++h) {
      EXPECT_EQ(poses[h]->root_position, expected[h]->root_position);
      EXPECT_EQ(poses[h]->rotations[1].coeffs(), expected[h]->rotations[1].coeffs());
    }
  }
}

TEST(RecentMotionTest, BeforeTheFirstPoseStandsTheFirstPose) {
  RecentMotion motion(2, kInterval, kDepth);
  ASSERT_THAT(motion.Add(5, PoseAtTime(5)), IsOk());
  for (const Pose* pose : HistoryOf(motion)) EXPECT_EQ(pose->root_position.x(), 5);
  ASSERT_THAT(motion.Add(5 + kInterval, PoseAtTime(5 + kInterval)), IsOk());
  const std::vector<const Pose*> poses = HistoryOf(motion);
  EXPECT_EQ(poses[1]->root_position.x(), 5);
  EXPECT_EQ(poses[3]->root_position.x(), 5);
}

TEST(RecentMotionTest, ARestartForgets) {
  RecentMotion motion(2, kInterval, kDepth);
  EXPECT_TRUE(motion.empty());
  ASSERT_THAT(motion.Add(1, PoseAtTime(1)), IsOk());
  ASSERT_THAT(motion.Add(2, PoseAtTime(2)), IsOk());
  motion.Restart();
  EXPECT_TRUE(motion.empty());
  ASSERT_THAT(motion.Add(0, PoseAtTime(7)), IsOk());
  for (const Pose* pose : HistoryOf(motion)) EXPECT_EQ(pose->root_position.x(), 7);
}

TEST(RecentMotionTest, TimeMustGoOn) {
  RecentMotion motion(2, kInterval, kDepth);
  ASSERT_THAT(motion.Add(1, PoseAtTime(1)), IsOk());
  for (const double seconds : {1., .5, kNan, HUGE_VAL}) {
    EXPECT_THAT(motion.Add(seconds, PoseAtTime(9)),
                HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("the pose")))
        << seconds;
  }
  EXPECT_EQ(HistoryOf(motion)[0]->root_position.x(), 1);
}

}  // namespace
}  // namespace pleat
