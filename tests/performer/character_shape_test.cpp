#include "character_shape.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "pleat/base/random.h"
#include "pleat/skeleton/human_template.h"

namespace pleat {
namespace {

using Eigen::Vector3d;

TEST(ShapePartTest, CapsulesHaveTheirExactDistance) {
  ShapePart capsule;
  capsule.kind = ShapePart::Kind::kCapsule;
  capsule.a = {0, 0, 0};
  capsule.b = {0, 1, 0};
  capsule.radius_a = .1;
  capsule.radius_b = .3;
  EXPECT_NEAR(capsule.Distance({.5, 0, 0}), .4, 1e-12);
  EXPECT_NEAR(capsule.Distance({0, 2, 0}), .7, 1e-12);
  EXPECT_NEAR(capsule.Distance({.2, .5, 0}), 0, 1e-12);  // radius .2 in the middle
  EXPECT_NEAR(capsule.Distance({0, -.05, 0}), -.05, 1e-12);
}

TEST(ShapePartTest, EllipsoidsAreZeroOnTheirSurfaceAndExactWhenRound) {
  ShapePart ellipsoid;
  ellipsoid.kind = ShapePart::Kind::kEllipsoid;
  ellipsoid.a = {1, 2, 3};
  ellipsoid.radii = {.5, .5, .5};
  EXPECT_NEAR(ellipsoid.Distance({2, 2, 3}), .5, 1e-12);
  EXPECT_NEAR(ellipsoid.Distance({1, 2, 3}), -.5, 1e-9);  // the center has no slope
  ellipsoid.radii = {.5, 1, 2};
  for (const Vector3d& axis : {Vector3d(.5, 0, 0), Vector3d(0, -1, 0), Vector3d(0, 0, 2)}) {
    EXPECT_NEAR(ellipsoid.Distance(ellipsoid.a + axis), 0, 1e-12);
    EXPECT_GT(ellipsoid.Distance(ellipsoid.a + 1.1 * axis), 0);
    EXPECT_LT(ellipsoid.Distance(ellipsoid.a + .9 * axis), 0);
  }
}

class CharacterShapeTest : public testing::TestWithParam<int> {
 protected:
  const CharacterShape shape_{static_cast<uint64_t>(GetParam())};
};

TEST_P(CharacterShapeTest, TheBoxHoldsTheWholeSurface) {
  const auto [low, high] = shape_.bounds();
  Random random(1);
  for (int i = 0; i < 3000; ++i) {
    Vector3d p;
    for (int c = 0; c < 3; ++c) p[c] = random.Uniform(low[c], high[c]);
    const int face = random.UniformInt(6);
    p[face / 2] = face % 2 == 0 ? low[face / 2] : high[face / 2];
    EXPECT_GT(shape_.Distance(p), 0) << p.transpose();
  }
}

TEST_P(CharacterShapeTest, JointsAreInsideAndTheFloorIsFlat) {
  for (int j = 0; j < kNumHumanJoints; ++j) {
    EXPECT_LT(shape_.Distance(shape_.skeleton().rest_position(j)), 0)
        << shape_.skeleton().joint(j).name;
  }
  Random random(2);
  for (int i = 0; i < 500; ++i) {
    EXPECT_GT(shape_.Distance({random.Uniform(-.3, .3), -.004, random.Uniform(-.2, .2)}), 0);
  }
}

// Left and right differ only in the skirt's folds.
TEST_P(CharacterShapeTest, TheBodyIsSymmetric) {
  Random random(3);
  for (int i = 0; i < 500; ++i) {
    const Vector3d p(random.Uniform(-.35, .35), random.Uniform(0, 1), random.Uniform(-.2, .2));
    const Vector3d mirrored(-p.x(), p.y(), p.z());
    // A smooth union depends a little on the order of its parts, and those of the bust have one.
    EXPECT_NEAR(shape_.RegionDistance(BodyRegion::kTorso, p),
                shape_.RegionDistance(BodyRegion::kTorso, mirrored), 3e-3);
    EXPECT_NEAR(shape_.RegionDistance(BodyRegion::kLeftArm, p),
                shape_.RegionDistance(BodyRegion::kRightArm, mirrored), 1e-9);
    EXPECT_NEAR(shape_.LegDistance(p), shape_.LegDistance(mirrored), 1e-9);
  }
}

TEST_P(CharacterShapeTest, RegionsAreWhereTheirNamesSay) {
  const Skeleton& skeleton = shape_.skeleton();
  EXPECT_EQ(shape_.NearestRegion(skeleton.rest_position(kLeftHand)), BodyRegion::kLeftArm);
  EXPECT_EQ(shape_.NearestRegion(skeleton.rest_position(kRightFoot)), BodyRegion::kRightLeg);
  EXPECT_EQ(shape_.NearestRegion(skeleton.rest_position(kHead)), BodyRegion::kTorso);
  const SkirtShape& skirt = shape_.skirt();
  EXPECT_EQ(shape_.NearestRegion(skirt.Point(.3, .9)), BodyRegion::kSkirt);
}

TEST_P(CharacterShapeTest, OnlyTheSkirtSwings) {
  const SkirtShape& skirt = shape_.skirt();
  for (double theta = 0; theta < 2 * std::numbers::pi; theta += .4) {
    const Vector3d p = skirt.Point(theta, .6);
    EXPECT_NEAR(skirt.Fraction(p.y()), .6, 1e-9);
    EXPECT_GT(shape_.SkirtShare(p), .85) << theta;
  }
  for (const int joint : {kHead, kLeftHand, kRightFoot, kChest}) {
    EXPECT_EQ(shape_.SkirtShare(shape_.skeleton().rest_position(joint)), 0);
  }
}

TEST_P(CharacterShapeTest, HandsAndHeadAreFinerThanTheTorso) {
  const Skeleton& skeleton = shape_.skeleton();
  const double torso = shape_.RelativeEdgeLength({0, .7, .05});
  EXPECT_EQ(torso, 1);
  EXPECT_LT(shape_.RelativeEdgeLength(skeleton.rest_position(kLeftHand)), .75);
  EXPECT_LT(shape_.RelativeEdgeLength({0, .95, 0}), .75);
}

INSTANTIATE_TEST_SUITE_P(Seeds, CharacterShapeTest, testing::Values(1, 2, 77));

TEST(CharacterShapeSeedTest, SeedsGiveOtherBodiesAndTheSameSeedTheSame) {
  const CharacterShape a(5), b(5), c(6);
  const Vector3d p(.1, .5, .1);
  EXPECT_EQ(a.Distance(p), b.Distance(p));
  EXPECT_NE(a.Distance(p), c.Distance(p));
  EXPECT_EQ(a.skeleton().RestPositions(), b.skeleton().RestPositions());
}

}  // namespace
}  // namespace pleat
