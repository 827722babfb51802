#include "pleat/motion/clean_feet.h"

#include <gtest/gtest.h>

#include "formats/figure_character.h"
#include "support/status_matchers.h"

namespace pleat {
namespace {

class CleanFeetTest : public testing::Test {
 protected:
  // The figure stands with bent knees while its root, and so its feet, drift and bob.
  PoseTrack Drift(int num_frames, double drift_per_frame_m) const {
    PoseTrack::Parts parts{.fps = 60};
    for (int t = 0; t < num_frames; ++t) {
      Pose pose = Pose::Rest(skeleton_);
      for (const int thigh : {kLeftLowerLeg, kRightLowerLeg}) {
        pose.rotations[thigh] = Eigen::AngleAxisd(-.3, Eigen::Vector3d::UnitX());
        pose.rotations[thigh + 1] = Eigen::AngleAxisd(.6, Eigen::Vector3d::UnitX());
        pose.rotations[thigh + 2] = Eigen::AngleAxisd(-.3, Eigen::Vector3d::UnitX());
      }
      pose.root_position += Eigen::Vector3d(drift_per_frame_m * t, .004 * std::sin(.3 * t), 0);
      parts.poses.push_back(std::move(pose));
    }
    return *PoseTrack::Create(std::move(parts));
  }

  const CharacterFile character_ = FigureCharacter(0);
  const Skeleton& skeleton_ = character_.rig.skeleton;
  const LegJoints legs_ = *FindLegJoints(skeleton_);
};

TEST_F(CleanFeetTest, FeetThatDriftStandStill) {
  const PoseTrack track = Drift(60, .001);
  CleanFeetSummary summary;
  PLEAT_ASSERT_OK_AND_ASSIGN(
      const PoseTrack clean,
      CleanFeet(skeleton_, track, TrackContacts(skeleton_, legs_, track), {}, &summary));
  EXPECT_GT(summary.before.num_frames, 100);
  EXPECT_NEAR(summary.before.mean_mm, 1, .1);
  EXPECT_LT(summary.after.mean_mm, 1e-6);
  EXPECT_EQ(summary.num_unreached_frames, 0);
  EXPECT_LT(summary.max_move_m, .04);
  const std::array<FootPath, 2> paths = FootPaths(skeleton_, legs_, clean.poses());
  for (const FootPath& path : paths) {
    EXPECT_LT((path.ankle.colwise() - path.ankle.col(0)).colwise().norm().maxCoeff(), 1e-6);
    EXPECT_LT((path.toes.colwise() - path.toes.col(0)).colwise().norm().maxCoeff(), 1e-6);
  }
  // Only the legs follow.
  for (int t = 0; t < 60; ++t) {
    EXPECT_LT(clean.pose(t).rotations[kChest].angularDistance(track.pose(t).rotations[kChest]),
              1e-9);
    EXPECT_EQ(clean.pose(t).root_position.x(), track.pose(t).root_position.x());
  }
}

TEST_F(CleanFeetTest, WhatStandsStillStays) {
  PoseTrack::Parts parts = Drift(40, 0).parts();
  for (Pose& pose : parts.poses) pose.root_position.y() = parts.poses[0].root_position.y();
  const PoseTrack track = *PoseTrack::Create(std::move(parts));
  CleanFeetSummary summary;
  PLEAT_ASSERT_OK_AND_ASSIGN(
      const PoseTrack clean,
      CleanFeet(skeleton_, track, TrackContacts(skeleton_, legs_, track), {}, &summary));
  EXPECT_LT(TrackDifference(clean, track), 1e-6);
}

TEST_F(CleanFeetTest, ARootThatIsTooHighSinksSmoothly) {
  PoseTrack::Parts parts = Drift(120, 0).parts();
  for (int t = 50; t < 70; ++t) {
    for (const int thigh : {kLeftLowerLeg, kRightLowerLeg}) {
      for (int b = thigh; b < thigh + 3; ++b) parts.poses[t].rotations[b].setIdentity();
    }
  }
  const PoseTrack track = *PoseTrack::Create(std::move(parts));
  std::array<FootContacts, 2> contacts;
  for (FootContacts& foot : contacts) {
    foot.heel.assign(120, true);
    foot.ball.assign(120, true);
  }
  CleanFeetSummary summary;
  PLEAT_ASSERT_OK_AND_ASSIGN(const PoseTrack clean,
                             CleanFeet(skeleton_, track, contacts, {}, &summary));
  for (int t = 1; t < 120; ++t) {
    EXPECT_LT((clean.pose(t).root_position - clean.pose(t - 1).root_position).norm(), .02) << t;
  }
  EXPECT_LT(summary.after.mean_mm, .5);
}

TEST_F(CleanFeetTest, ASkeletonWithoutLegsIsRefused) {
  const Skeleton skeleton = *Skeleton::Create({{"a", -1, {0, 0, 0}}, {"b", 0, {0, 1, 0}}});
  PoseTrack::Parts parts;
  parts.poses = {Pose::Rest(skeleton)};
  FootContacts none{{false}, {false}};
  CleanFeetSummary summary;
  EXPECT_THAT(CleanFeet(skeleton, *PoseTrack::Create(std::move(parts)), {none, none}, {}, &summary),
              HasStatus(kInvalid, testing::HasSubstr("two legs")));
}

}  // namespace
}  // namespace pleat
