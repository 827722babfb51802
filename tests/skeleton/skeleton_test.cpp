#include "pleat/skeleton/skeleton.h"

#include <gtest/gtest.h>

#include <limits>

#include "support/status_matchers.h"

namespace pleat {
namespace {

using ::testing::HasSubstr;

std::vector<Joint> ThreeJoints() {
  return {{"root", -1, {0, 1, 0}}, {"a", 0, {0, 2, 0}}, {"b", 1, {1, 2, 0}}};
}

TEST(SkeletonTest, KnowsItsHierarchy) {
  PLEAT_ASSERT_OK_AND_ASSIGN(const Skeleton skeleton, Skeleton::Create(ThreeJoints()));
  EXPECT_EQ(skeleton.num_joints(), 3);
  EXPECT_EQ(skeleton.parent(0), -1);
  EXPECT_EQ(skeleton.parent(2), 1);
  EXPECT_EQ(skeleton.children(0), std::vector<int>{1});
  EXPECT_TRUE(skeleton.children(2).empty());
  EXPECT_EQ(skeleton.FindJoint("b"), 2);
  EXPECT_EQ(skeleton.FindJoint("c"), -1);
}

TEST(SkeletonTest, WithRestPositionsMovesJointsOnly) {
  PLEAT_ASSERT_OK_AND_ASSIGN(const Skeleton skeleton, Skeleton::Create(ThreeJoints()));
  const Eigen::Matrix3Xd moved = 2 * skeleton.RestPositions();
  const Skeleton other = skeleton.WithRestPositions(moved);
  EXPECT_EQ(other.RestPositions(), moved);
  EXPECT_EQ(other.joint(1).name, "a");
  EXPECT_EQ(other.parent(2), 1);
  EXPECT_EQ(skeleton.rest_position(1), Eigen::Vector3d(0, 2, 0));
}

TEST(SkeletonTest, RefusesWhatIsNoHierarchy) {
  const auto invalid = absl::StatusCode::kInvalidArgument;
  EXPECT_THAT(Skeleton::Create({}), HasStatus(invalid, HasSubstr("at least one")));
  for (const int parent : {-1, 1, 2, 7, -5}) {  // second root, itself, later, absent, negative
    std::vector<Joint> joints = ThreeJoints();
    joints[1].parent = parent;
    EXPECT_THAT(Skeleton::Create(joints), HasStatus(invalid, HasSubstr("joint 1"))) << parent;
  }
  std::vector<Joint> joints = ThreeJoints();
  joints[0].parent = 0;
  EXPECT_THAT(Skeleton::Create(joints), HasStatus(invalid, HasSubstr("joint 0")));
  joints = ThreeJoints();
  joints[2].name = "a";
  EXPECT_THAT(Skeleton::Create(joints), HasStatus(invalid, HasSubstr("twice")));
  joints[2].name = "";
  EXPECT_THAT(Skeleton::Create(joints), HasStatus(invalid, HasSubstr("empty")));
  joints = ThreeJoints();
  joints[2].rest_position.y() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(Skeleton::Create(joints), HasStatus(invalid, HasSubstr("not finite")));
}

}  // namespace
}  // namespace pleat
