#include "pleat/skeleton/pose_track.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <utility>

#include "pleat/skeleton/human_template.h"
#include "support/smooth_poses.h"
#include "support/status_matchers.h"

namespace pleat {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

PoseTrack::Parts GoodParts() {
  PoseTrack::Parts parts = MakeSmoothPoses(HumanTemplate(), 6, 1).Take();
  parts.clip_starts = {0, 4};
  return parts;
}

// Expects that Create refuses the parts after `change`, with all these words.
template <typename Change, typename... Words>
void ExpectRefused(Change change, const Words&... words) {
  PoseTrack::Parts parts = GoodParts();
  change(&parts);
  EXPECT_THAT(PoseTrack::Create(std::move(parts)),
              HasStatus(absl::StatusCode::kInvalidArgument, AllOf(HasSubstr(words)...)));
}

TEST(PoseTrackTest, KeepsWhatItWasMadeOf) {
  const PoseTrack::Parts parts = GoodParts();
  PLEAT_ASSERT_OK_AND_ASSIGN(const PoseTrack track, PoseTrack::Create(parts));
  EXPECT_EQ(track.num_frames(), 6);
  EXPECT_EQ(track.num_joints(), kNumHumanJoints);
  EXPECT_EQ(track.fps(), 30);
  EXPECT_THAT(track.clip_starts(), ElementsAre(0, 4));
  EXPECT_EQ(track.pose(5).root_position, parts.poses[5].root_position);
}

TEST(PoseTrackTest, TheFirstFaultIsNamed) {
  using Parts = PoseTrack::Parts;
  for (const double fps : {0.0, -25.0, kNan, kInfinity}) {
    ExpectRefused([fps](Parts* parts) { parts->fps = fps; }, "fps");
  }
  ExpectRefused([](Parts* parts) { parts->poses.clear(); }, "empty");
  ExpectRefused([](Parts* parts) { parts->poses[0].rotations.clear(); }, "frame 0", "no rotations");
  ExpectRefused([](Parts* parts) { parts->poses[3].rotations.pop_back(); }, "frame 3",
                "17 rotations", "18");
  ExpectRefused([](Parts* parts) { parts->poses[2].root_position.y() = kNan; }, "frame 2",
                "root position");
  ExpectRefused([](Parts* parts) { parts->poses[2].rotations[5].w() = kNan; }, "frame 2",
                "joint 5");
  ExpectRefused([](Parts* parts) { parts->poses[5].rotations[7].coeffs() *= 1.02; }, "frame 5",
                "joint 7", "norm 1.02");
  for (const std::vector<int>& starts :
       std::vector<std::vector<int>>{{}, {1}, {-1}, {0, 0}, {0, 6}, {0, 4, 2}, {0, -1}}) {
    ExpectRefused([&starts](Parts* parts) { parts->clip_starts = starts; }, "clip starts");
  }
}

TEST(PoseTrackTest, RotationsNeedBeUnitOnlyToOnePercent) {
  PoseTrack::Parts parts = GoodParts();
  parts.poses[1].rotations[1].coeffs() *= 1.009;
  EXPECT_THAT(PoseTrack::Create(parts), IsOk());
}

TEST(PoseTrackTest, FramesKnowTheirClip) {
  const PoseTrack track = PoseTrack::FromValid(GoodParts());
  for (int t = 0; t < 6; ++t) {
    const ClipRange clip = track.ClipOf(t);
    EXPECT_EQ(clip.clip, t < 4 ? 0 : 1) << t;
    EXPECT_EQ(clip.begin, t < 4 ? 0 : 4) << t;
    EXPECT_EQ(clip.end, t < 4 ? 4 : 6) << t;
    EXPECT_EQ(track.StartsClip(t), t == 0 || t == 4) << t;
  }
}

TEST(PoseTrackTest, ASubsetIsOneClip) {
  const PoseTrack track = PoseTrack::FromValid(GoodParts());
  const PoseTrack part = track.Subset({5, 1});
  EXPECT_EQ(part.num_frames(), 2);
  EXPECT_THAT(part.clip_starts(), ElementsAre(0));
  EXPECT_EQ(part.pose(0).root_position, track.pose(5).root_position);
}

TEST(PoseTrackTest, ATrackWithoutFramesIsNoTrackYet) {
  PoseTrack taken = PoseTrack::FromValid(GoodParts());
  EXPECT_EQ(std::move(taken).Take().poses.size(), 6u);
  for (const PoseTrack& none : {PoseTrack(), taken}) {  // NOLINT(bugprone-use-after-move)
    EXPECT_EQ(none.num_frames(), 0);
    EXPECT_EQ(none.num_joints(), 0);
    EXPECT_THAT(CheckJointCount(none, 18), IsOk());
  }
}

TEST(PoseTrackTest, JointCountsAreComparedWithASkeleton) {
  const PoseTrack track = PoseTrack::FromValid(GoodParts());
  EXPECT_THAT(CheckJointCount(track, 18), IsOk());
  EXPECT_THAT(
      CheckJointCount(track, 17),
      HasStatus(absl::StatusCode::kInvalidArgument,
                AllOf(HasSubstr("frame 0"), HasSubstr("18 rotations"), HasSubstr("17 joints"))));
}

}  // namespace
}  // namespace pleat
