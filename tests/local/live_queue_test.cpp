#include "pleat/local/live_queue.h"

#include <gtest/gtest.h>

#include "support/status_matchers.h"

namespace pleat {
namespace {

using std::chrono::milliseconds;
using ::testing::HasSubstr;
using Time = std::chrono::steady_clock::time_point;

// A pose of two joints that can be told from others by its height.
Pose MakePose(double y, size_t num_joints = 2) {
  Pose pose;
  pose.root_position = Eigen::Vector3d(0, y, 0);
  pose.rotations.assign(num_joints, Eigen::Quaterniond::Identity());
  return pose;
}

LivePose Numbered(int number) {
  return {.number = static_cast<uint64_t>(number), .pose = MakePose(number)};
}

std::vector<double> Heights(const LiveTurn& turn) {
  std::vector<double> heights;
  for (const Pose& pose : turn.poses) heights.push_back(pose.root_position.y());
  return heights;
}

TEST(LiveQueueTest, EveryPoseInOrderWithItsHistory) {
  LiveQueue queue({.max_in_flight = 2, .latest_wins = false}, 3, 2);
  EXPECT_TRUE(queue.HasRoom());
  EXPECT_FALSE(queue.ready());
  queue.Push(Numbered(1), Time(milliseconds(5)));
  EXPECT_TRUE(queue.HasRoom());
  queue.Push(Numbered(2), Time(milliseconds(6)));
  EXPECT_FALSE(queue.HasRoom());
  const LiveTurn first = queue.Take();
  EXPECT_EQ(first.number, 1u);
  EXPECT_EQ(first.arrived, Time(milliseconds(5)));
  EXPECT_EQ(Heights(first), (std::vector<double>{1}));
  EXPECT_TRUE(queue.HasRoom());
  queue.Push(Numbered(3), Time());
  EXPECT_EQ(Heights(queue.Take()), (std::vector<double>{2, 1}));
  queue.Push(Numbered(4), Time());
  EXPECT_EQ(Heights(queue.Take()), (std::vector<double>{3, 2, 1}));
  const LiveTurn last = queue.Take();
  EXPECT_EQ(Heights(last), (std::vector<double>{4, 3, 2}));
  EXPECT_EQ(last.num_superseded, 0);
  EXPECT_TRUE(queue.empty());
}

TEST(LiveQueueTest, ACutAndAGivenHistoryReplaceTheOldOne) {
  LiveQueue queue({}, 3, 2);
  queue.Push(Numbered(1), Time());
  LivePose cut = Numbered(2);
  cut.restart = true;
  queue.Push(cut, Time());
  LivePose with_history = Numbered(3);
  with_history.history = {MakePose(.5), MakePose(.25), MakePose(.125)};
  queue.Push(with_history, Time());
  queue.Push(Numbered(4), Time());
  queue.Take();
  EXPECT_EQ(Heights(queue.Take()), (std::vector<double>{2}));
  EXPECT_EQ(Heights(queue.Take()), (std::vector<double>{3, .5, .25}));
  EXPECT_EQ(Heights(queue.Take()), (std::vector<double>{4, 3, .5}));
}

TEST(LiveQueueTest, TheNewestWinsAndSupersededPosesStayHistory) {
  LiveQueue queue({.max_in_flight = 2, .latest_wins = true}, 4, 2);
  queue.Push(Numbered(1), Time());
  ASSERT_TRUE(queue.ready());
  EXPECT_EQ(queue.Take().number, 1u);
  for (int i = 2; i <= 1000; ++i) {
    LivePose pose = Numbered(i);
    pose.keyframe = i == 500;
    EXPECT_TRUE(queue.HasRoom());
    queue.Push(std::move(pose), Time());
  }
  const LiveTurn turn = queue.Take();
  EXPECT_EQ(turn.number, 1000u);
  EXPECT_EQ(turn.num_superseded, 998);
  EXPECT_TRUE(turn.keyframe);
  EXPECT_EQ(Heights(turn), (std::vector<double>{1000, 999, 998, 997}));
  queue.Push(Numbered(1001), Time());
  EXPECT_FALSE(queue.ready()) << "two replies are under way";
  EXPECT_THAT(queue.Acknowledge(1), IsOk());
  EXPECT_TRUE(queue.ready());
  EXPECT_EQ(queue.Take().num_superseded, 0);
}

TEST(LiveQueueTest, AcknowledgesOnlyWhatWasSent) {
  LiveQueue queue({.max_in_flight = 1, .latest_wins = true}, 1, 2);
  EXPECT_THAT(queue.Acknowledge(1),
              HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("only 0 were sent")));
  queue.Push(Numbered(1), Time());
  queue.Take();
  EXPECT_THAT(queue.Acknowledge(1), IsOk());
  EXPECT_THAT(queue.Acknowledge(0), IsOk());  // an old message changes nothing
  queue.Push(Numbered(2), Time());
  EXPECT_TRUE(queue.ready());
  EXPECT_FALSE(queue.Acknowledge(~uint64_t{0}).ok());
}

TEST(LiveQueueTest, BadPosesAreAnsweredAndNoHistory) {
  LiveQueue queue({}, 3, 2);
  queue.Push(Numbered(1), Time());
  queue.Push({.number = 2, .pose = MakePose(2, 3)}, Time());
  queue.Push({.number = 3, .status = absl::InvalidArgumentError("not finite"), .restart = true},
             Time());
  LivePose bad_history = Numbered(4);
  bad_history.history = {MakePose(9), MakePose(8, 1)};
  queue.Push(bad_history, Time());
  queue.Push(Numbered(5), Time());
  queue.Take();
  EXPECT_THAT(queue.Take().status,
              HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("3 rotations")));
  EXPECT_THAT(queue.Take().status,
              HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("not finite")));
  EXPECT_THAT(queue.Take().status,
              HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("history[1]")));
  EXPECT_EQ(Heights(queue.Take()), (std::vector<double>{5, 1}));
}

}  // namespace
}  // namespace pleat
