#include "body_axes.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "blending.h"
#include "formats/figure_character.h"
#include "support/status_matchers.h"

namespace pleat {
namespace {

TEST(BodyAxesTest, LeftAndRightAreFoundByNames) {
  const CharacterFile character = FigureCharacter(0);
  const Skeleton& skeleton = character.rig.skeleton;
  const BodyAxes axes = FindBodyAxes(skeleton).value();
  EXPECT_NEAR(axes.left.dot(axes.front), 0, 1e-12);
  EXPECT_NEAR(axes.left.y(), 0, 1e-12);
  const auto hand = static_cast<size_t>(skeleton.FindJoint("leftHand"));
  EXPECT_EQ(axes.mirror_joints[hand], skeleton.FindJoint("rightHand"));
  EXPECT_EQ(axes.mirror_joints[0], 0);
  EXPECT_GT(axes.left.dot(skeleton.rest_position(static_cast<int>(hand)) -
                          skeleton.rest_position(axes.mirror_joints[hand])),
            0);
}

TEST(BodyAxesTest, ABodyWithoutSidesHasNoFront) {
  const Skeleton chain = *Skeleton::Create({{"a", -1, {0, 0, 0}}, {"b", 0, {0, 1, 0}}});
  EXPECT_THAT(FindBodyAxes(chain),
              HasStatus(absl::StatusCode::kInvalidArgument, testing::HasSubstr("left and right")));
}

TEST(BodyAxesTest, MovesOnTheGroundAreAGroup) {
  const GroundMove a{.7, {1, 0, 2}}, b{-1.9, {-3, 0, .5}};
  const CharacterFile character = FigureCharacter(2);
  const Pose start = character.track.pose(1);
  Pose at_once = start, one_by_one = start, back = start;
  (a * b).Apply(&at_once);
  b.Apply(&one_by_one);
  a.Apply(&one_by_one);
  EXPECT_LT((at_once.root_position - one_by_one.root_position).norm(), 1e-12);
  EXPECT_LT(at_once.rotations[0].angularDistance(one_by_one.rotations[0]), 1e-7);
  a.Apply(&back);
  a.Inverse().Apply(&back);
  EXPECT_LT((back.root_position - start.root_position).norm(), 1e-12);
}

TEST(BodyAxesTest, APoseIsWhereItWasMovedTo) {
  const CharacterFile character = FigureCharacter(0);
  const BodyAxes axes = FindBodyAxes(character.rig.skeleton).value();
  Pose pose = Pose::Rest(character.rig.skeleton);
  pose.root_position = {0, pose.root_position.y(), 0};
  GroundMove{40 * kDegree, {2, 0, -1}}.Apply(&pose);
  const GroundMove found = GroundOf(pose, axes);
  EXPECT_NEAR(found.yaw_rad, 40 * kDegree, 1e-9);
  EXPECT_LT((found.shift - Eigen::Vector3d(2, 0, -1)).norm(), 1e-12);
}

}  // namespace
}  // namespace pleat
