#include "time_edits.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "formats/figure_character.h"
#include "pleat/motion/apply_edits.h"
#include "support/status_matchers.h"

namespace pleat {
namespace {

using testing::HasSubstr;

constexpr absl::StatusCode kWrong = absl::StatusCode::kInvalidArgument;

class TimeEditsTest : public testing::Test {
 protected:
  // The root goes to the left by 1 cm a frame, or by `speed`, from each clip's start on.
  PoseTrack Walk(int num_frames, double fps = 20, std::vector<int> clip_starts = {0},
                 double speed = .01) const {
    PoseTrack::Parts parts{.fps = fps, .clip_starts = clip_starts};
    for (int t = 0; t < num_frames; ++t) {
      parts.poses.push_back(Pose::Rest(skeleton_));
      parts.poses.back().root_position += t * speed * axes_.left;
    }
    return PoseTrack::Create(std::move(parts)).value();
  }
  // How far the root has gone to the left since the rest, meters.
  double Way(const PoseTrack& track, int t) const {
    return axes_.left.dot(track.pose(t).root_position - Pose::Rest(skeleton_).root_position);
  }

  const CharacterFile character_ = FigureCharacter(0);
  const Skeleton& skeleton_ = character_.rig.skeleton;
  const BodyAxes axes_ = FindBodyAxes(skeleton_).value();
};

TEST_F(TimeEditsTest, HalfAsFastIsTwiceAsLongAndEndsAtTheSamePlace) {
  const PoseTrack slow = ScaleTime(Walk(11), 2).value();
  ASSERT_EQ(slow.num_frames(), 21);
  EXPECT_NEAR(Way(slow, 1), .005, 1e-12);
  EXPECT_NEAR(Way(slow, 20), .1, 1e-12);
  EXPECT_EQ(slow.fps(), 20);
}

TEST_F(TimeEditsTest, ClipsAreScaledEachOnItsOwn) {
  const PoseTrack slow = ScaleTime(Walk(10, 20, {0, 4}), 2).value();
  EXPECT_EQ(slow.clip_starts(), (std::vector<int>{0, 7}));
  EXPECT_NEAR(Way(slow, 6), .03, 1e-12);
  EXPECT_NEAR(Way(slow, 7), .04, 1e-12);
}

TEST_F(TimeEditsTest, AnotherFrameRateIsTheSameMotion) {
  const PoseTrack fine = ResampleTime(Walk(11), 40).value();
  EXPECT_EQ(fine.fps(), 40);
  ASSERT_EQ(fine.num_frames(), 21);
  EXPECT_NEAR(Way(fine, 20), .1, 1e-12);
  const PoseTrack back = ResampleTime(fine, 20).value();
  EXPECT_EQ(back.num_frames(), 11);
  EXPECT_NEAR(Way(back, 7), .07, 1e-12);
}

TEST_F(TimeEditsTest, AWarpBringsWhatWasThereAndNeverTurnsBack) {
  const PoseTrack warped = WarpTime(Walk(21), {0, .5, 1}, {0, .8, 1}).value();
  ASSERT_EQ(warped.num_frames(), 21);
  EXPECT_NEAR(Way(warped, 16), .1, 1e-9);  // .5 s of the motion comes at .8 s
  EXPECT_NEAR(Way(warped, 20), .2, 1e-9);
  for (int t = 1; t <= 20; ++t) EXPECT_GT(Way(warped, t), Way(warped, t - 1)) << t;
}

TEST_F(TimeEditsTest, KeysThatMakeNoSenseAreSaid) {
  const PoseTrack walk = Walk(21);
  EXPECT_THAT(WarpTime(walk, {0}, {0}), HasStatus(kWrong, HasSubstr("two keys")));
  EXPECT_THAT(WarpTime(walk, {0, .5, .5}, {0, 1, 2}), HasStatus(kWrong, HasSubstr("key 2")));
  EXPECT_THAT(WarpTime(walk, {0, 5}, {0, 5}), HasStatus(kWrong, HasSubstr("ends at 1 s")));
  EXPECT_THAT(WarpTime(Walk(9, 20, {0, 4}), {0, .1}, {0, .1}),
              HasStatus(kWrong, HasSubstr("2 clips")));
  EXPECT_THAT(WarpTime(walk, {0, 1}, {0, 1e9}),
              HasStatus(absl::StatusCode::kResourceExhausted, HasSubstr("limit")));
}

TEST_F(TimeEditsTest, ATrimKeepsTheFramesBetween) {
  const PoseTrack kept = TrimTime(Walk(21), .25, .5).value();
  ASSERT_EQ(kept.num_frames(), 6);
  EXPECT_NEAR(Way(kept, 0), .05, 1e-12);
  EXPECT_NEAR(Way(kept, 5), .1, 1e-12);
  EXPECT_THAT(TrimTime(Walk(21), 3, 4), HasStatus(kWrong, HasSubstr("no frame")));
}

TEST_F(TimeEditsTest, ALoopGoesOnFromWhereItHasCome) {
  const PoseTrack looped = LoopTrack(Walk(21), .2, 3, axes_).value();
  EXPECT_GT(looped.num_frames(), 41);
  for (int t = 1; t < looped.num_frames(); ++t) {
    const double step = Way(looped, t) - Way(looped, t - 1);
    EXPECT_GE(step, -1e-9) << t;
    EXPECT_LT(step, .03) << t;
  }
  EXPECT_THAT(LoopTrack(Walk(1), .2, 3, axes_), HasStatus(kWrong, HasSubstr("no loop")));
}

TEST_F(TimeEditsTest, ABlendWithoutWeightIsTheTrack) {
  const PoseTrack walk = Walk(11), other = Walk(11, 20, {0}, .02);
  const std::vector<int> all = {0, 1, 2};
  const PoseTrack same = BlendTracks(walk, other, all, 0, axes_).value();
  EXPECT_LT(TrackDifference(same, walk), 1e-12);
  const PoseTrack half = BlendTracks(walk, other, all, .5, axes_).value();
  EXPECT_NEAR(Way(half, 10), .15, 1e-9);
}

TEST_F(TimeEditsTest, WhatFollowsBeginsWhereTheFirstOneIs) {
  const PoseTrack joined = ConcatenateTracks(Walk(21), Walk(21), .25, axes_).value();
  ASSERT_EQ(joined.num_frames(), 15 + 21);
  for (int t = 1; t < joined.num_frames(); ++t) {
    EXPECT_NEAR(Way(joined, t) - Way(joined, t - 1), .01, 1e-9) << t;
  }
}

}  // namespace
}  // namespace pleat
