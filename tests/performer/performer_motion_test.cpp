#include "performer_motion.h"

#include <gtest/gtest.h>

#include <cmath>

#include "pleat/skeleton/human_template.h"
#include "pleat/skinning/rig.h"

namespace pleat {
namespace {

Eigen::Matrix3Xd JointsOf(const Skeleton& skeleton, const Pose& pose) {
  BoneTransforms bones;
  ComputeBoneTransforms(skeleton, pose, {}, &bones);
  return bones.joint_positions;
}

class PerformerMotionTest : public testing::TestWithParam<PerformerStyle> {
 protected:
  PoseTrack Generate(int num_frames, uint64_t seed = 1, double fps = 30) const {
    return GenerateMotion(
        HumanTemplate(), {.seed = seed, .style = GetParam(), .num_frames = num_frames, .fps = fps});
  }
};

TEST_P(PerformerMotionTest, BeginsInTheRestPose) {
  const Pose first = Generate(3).poses()[0], rest = Pose::Rest(HumanTemplate());
  EXPECT_LT((first.root_position - rest.root_position).norm(), 1e-12);
  for (size_t j = 0; j < first.rotations.size(); ++j) {
    EXPECT_LT(first.rotations[j].angularDistance(rest.rotations[j]), 1e-9) << j;
  }
}

TEST_P(PerformerMotionTest, FirstFramesDoNotDependOnTheLength) {
  const PoseTrack shorter = Generate(40), longer = Generate(90);
  for (int t = 0; t < 40; ++t) {
    EXPECT_EQ(shorter.poses()[t].root_position, longer.poses()[t].root_position) << t;
    for (size_t j = 0; j < shorter.poses()[t].rotations.size(); ++j) {
      EXPECT_EQ(shorter.poses()[t].rotations[j].coeffs(), longer.poses()[t].rotations[j].coeffs());
    }
  }
}

TEST_P(PerformerMotionTest, IsSmoothAtAnyRate) {
  for (const double fps : {24., 60., 120.}) {
    const PoseTrack track = Generate(static_cast<int>(4 * fps), 3, fps);
    EXPECT_EQ(track.fps(), fps);
    for (int t = 1; t < track.num_frames(); ++t) {
      const Pose &a = track.poses()[t - 1], &b = track.poses()[t];
      EXPECT_LT((a.root_position - b.root_position).norm() * fps, 3) << t;  // body heights per s
      for (size_t j = 0; j < a.rotations.size(); ++j) {
        EXPECT_NEAR(b.rotations[j].norm(), 1, 1e-9);
        EXPECT_LT(a.rotations[j].angularDistance(b.rotations[j]) * fps, 40) << t << " " << j;
      }
    }
  }
}

TEST_P(PerformerMotionTest, FeetStayAboveTheFloorAndOneOfThemUsuallyStands) {
  const PoseTrack track = Generate(240);
  const double rest_height = HumanTemplate().rest_position(kLeftFoot).y();
  int num_on_floor = 0;
  for (const Pose& pose : track.poses()) {
    const Eigen::Matrix3Xd joints = JointsOf(HumanTemplate(), pose);
    const double lowest = std::min(joints(1, kLeftFoot), joints(1, kRightFoot));
    EXPECT_GT(lowest, rest_height - .02);
    num_on_floor += lowest < rest_height + .03;
  }
  EXPECT_GT(num_on_floor, 160);
}

TEST_P(PerformerMotionTest, SeedsDecideTheMotion) {
  const PoseTrack a = Generate(60, 1), b = Generate(60, 1), c = Generate(60, 2);
  EXPECT_EQ(a.poses()[59].root_position, b.poses()[59].root_position);
  EXPECT_NE(a.poses()[59].root_position, c.poses()[59].root_position);
}

INSTANTIATE_TEST_SUITE_P(Styles, PerformerMotionTest,
                         testing::Values(PerformerStyle::kWalk, PerformerStyle::kDance));

TEST(PerformerMotionStyleTest, AWalkGoesFartherThanADance) {
  const auto farthest = [](PerformerStyle style) {
    double distance = 0;
    const PoseTrack track = GenerateMotion(HumanTemplate(), {.style = style, .num_frames = 120});
    for (const Pose& pose : track.poses()) {
      distance = std::max(distance, (pose.root_position - track.poses()[0].root_position).norm());
    }
    return distance;
  };
  EXPECT_GT(farthest(PerformerStyle::kWalk), 2 * farthest(PerformerStyle::kDance));
}

}  // namespace
}  // namespace pleat
