#include "pleat/motion/leg_joints.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "formats/figure_character.h"
#include "support/status_matchers.h"

namespace pleat {
namespace {

TEST(LegJointsTest, TheLegsOfTheFigureAreKnown) {
  const CharacterFile character = FigureCharacter(0);
  const Skeleton& skeleton = character.rig.skeleton;
  const LegJoints legs = FindLegJoints(skeleton).value();
  EXPECT_EQ(legs.legs[0].ankle, skeleton.FindJoint("leftFoot"));
  EXPECT_EQ(legs.legs[1].knee, skeleton.FindJoint("rightLowerLeg"));
  const double shank =
      (skeleton.rest_position(legs.legs[0].ankle) - skeleton.rest_position(legs.legs[0].knee))
          .norm();
  EXPECT_GT(legs.MeanLength(skeleton), shank);
  EXPECT_LT(legs.MeanLength(skeleton), 4 * shank);
}

TEST(LegJointsTest, FeetGoWhereTheirJointsGo) {
  const CharacterFile character = FigureCharacter(3);
  const Skeleton& skeleton = character.rig.skeleton;
  const LegJoints legs = FindLegJoints(skeleton).value();
  const auto paths = FootPaths(skeleton, legs, character.track.poses());
  BoneTransforms transforms;
  ComputeBoneTransforms(skeleton, character.track.pose(2), {}, &transforms);
  for (size_t side = 0; side < 2; ++side) {
    EXPECT_EQ(paths[side].ankle.cols(), 3);
    EXPECT_EQ(paths[side].ankle.col(2), transforms.joint_positions.col(legs.legs[side].ankle));
  }
}

TEST(LegJointsTest, ABodyWithoutLegsIsRefused) {
  const Skeleton chain = *Skeleton::Create({{"hips", -1, {0, 0, 0}}, {"chest", 0, {0, 1, 0}}});
  EXPECT_THAT(FindLegJoints(chain),
              HasStatus(absl::StatusCode::kInvalidArgument, testing::HasSubstr("two legs")));
}

}  // namespace
}  // namespace pleat
