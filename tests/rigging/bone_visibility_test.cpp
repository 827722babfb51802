#include "pleat/rigging/bone_visibility.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/status_matchers.h"
#include "support/triangle_shapes.h"

namespace pleat {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

TEST(BoneVisibilityTest, ClosestPointOnSegmentIsClamped) {
  const Eigen::Vector3d a(0, 0, 0), b(2, 0, 0);
  EXPECT_EQ(ClosestPointOnSegment({1, 5, 0}, a, b), Eigen::Vector3d(1, 0, 0));
  EXPECT_EQ(ClosestPointOnSegment({-3, 1, 0}, a, b), a);
  EXPECT_EQ(ClosestPointOnSegment({9, 1, 0}, a, b), b);
  EXPECT_EQ(ClosestPointOnSegment({9, 1, 0}, a, a), a);
}

// Two pillars side by side, joined at the bottom.
class PillarsTest : public ::testing::Test {
 protected:
  PillarsTest()
      : mesh_(MakeCapsuleBody({{{-.3, 0, 0}, {-.3, 2, 0}, .2, .2},
                               {{.3, 0, 0}, {.3, 2, 0}, .2, .2},
                               {{-.3, 0, 0}, {.3, 0, 0}, .2, .2}},
                              .05)),
        tree_(mesh_.positions, mesh_.triangles),
        winding_number_(tree_) {}

  TriangleMesh mesh_;
  TriangleTree tree_;
  WindingNumber winding_number_;
  InsideTest inside_{&tree_, &winding_number_, nullptr};
};

TEST_F(PillarsTest, TheGapHidesTheOtherPillar) {
  const double tolerance = .005;
  PLEAT_ASSERT_OK_AND_ASSIGN(const DistanceField field,
                             DistanceField::Compute(tree_, winding_number_, {.resolution = 48}));
  for (const InsideTest& inside : {InsideTest{&tree_, &winding_number_, nullptr},
                                   InsideTest{&tree_, &winding_number_, &field}}) {
    EXPECT_TRUE(IsVisibleInside(inside, {-.3, 1, 0}, {-.1, 1, 0}, tolerance));
    EXPECT_TRUE(IsVisibleInside(inside, {-.3, .2, 0}, {-.5, 1, 0}, tolerance));
    EXPECT_FALSE(IsVisibleInside(inside, {.3, 1, 0}, {-.1, 1, 0}, tolerance));
    EXPECT_FALSE(IsVisibleInside(inside, {0, 1, 0}, {-.1, 1, 0}, tolerance));
    EXPECT_FALSE(IsVisibleInside(inside, {3, 1, 0}, {.5, 1, 0}, tolerance));
  }
}

TEST_F(PillarsTest, NearestBoneIsTheNearestOneInSight) {
  // The bone of the right pillar leans towards the left one and is nearer to its inner side.
  const Skeleton skeleton = *Skeleton::Create(
      {{"root", -1, {0, 0, 0}}, {"left", 0, {-.45, 1.5, 0}}, {"right", 0, {.12, 1.5, 0}}});
  const Eigen::Vector3d vertex(-.1, 1, 0);
  const auto nearest = [&](const InsideTest* inside) {
    return FindNearestBones(skeleton, skeleton.RestPositions(), vertex, inside, .005);
  };
  EXPECT_THAT(nearest(nullptr).bones, ElementsAre(2));
  const NearestBones seen = nearest(&inside_);
  EXPECT_THAT(seen.bones, ElementsAre(1));
  EXPECT_GT(seen.distance, nearest(nullptr).distance);
}

TEST_F(PillarsTest, TiesAreShared) {
  const Skeleton skeleton = *Skeleton::Create(
      {{"root", -1, {0, 0, 0}}, {"left", 0, {-.3, 0, 0}}, {"right", 0, {.3, 0, 0}}});
  const NearestBones nearest =
      FindNearestBones(skeleton, skeleton.RestPositions(), {0, .2, 0}, &inside_, .005);
  EXPECT_THAT(nearest.bones, ElementsAre(1, 2));
  EXPECT_THAT(FindNearestBones(skeleton, skeleton.RestPositions(), {5, 5, 0}, &inside_, .005).bones,
              IsEmpty());
}

}  // namespace
}  // namespace pleat
