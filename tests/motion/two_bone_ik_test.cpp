#include "pleat/motion/two_bone_ik.h"

#include <gtest/gtest.h>

#include "pleat/base/random.h"

namespace pleat {
namespace {

struct Solved {
  Eigen::Vector3d middle, end;
};

Solved Apply(const TwoBoneLimb& limb, const TwoBoneTurns& turns) {
  const Eigen::Vector3d middle = limb.begin + turns.upper * (limb.middle - limb.begin);
  return {middle, middle + turns.lower * (limb.end - limb.middle)};
}

Eigen::Vector3d RandomVector(Random* random) {
  return {random->Uniform(-1, 1), random->Uniform(-1, 1), random->Uniform(-1, 1)};
}

TEST(TwoBoneIkTest, ReachesGoalsAndKeepsLengthsAndPlane) {
  Random random(7);
  for (int i = 0; i < 500; ++i) {
    TwoBoneLimb limb{.begin = RandomVector(&random), .middle = {}, .end = {}, .hinge = {}};
    limb.middle = limb.begin + RandomVector(&random);
    limb.end = limb.middle + RandomVector(&random);
    const Eigen::Vector3d upper = limb.middle - limb.begin, lower = limb.end - limb.middle;
    limb.hinge = upper.cross(lower).normalized();
    const double longest = upper.norm() + lower.norm();
    const double shortest = std::abs(upper.norm() - lower.norm());
    const double distance = shortest + random.Uniform(.05, .95) * (longest - shortest);
    const Eigen::Vector3d goal = limb.begin + distance * RandomVector(&random).normalized();
    const TwoBoneTurns turns = SolveTwoBone(limb, goal);
    const Solved solved = Apply(limb, turns);
    ASSERT_TRUE(turns.reached);
    EXPECT_LT((solved.end - goal).norm(), 1e-9);
    EXPECT_NEAR((turns.upper.transpose() * turns.upper).trace(), 3, 1e-9);
    // It bends about its hinge, to the same side.
    const Eigen::Vector3d bend = (solved.middle - limb.begin).cross(goal - solved.middle);
    EXPECT_GT(bend.normalized().dot(turns.upper * limb.hinge), 1 - 1e-6);
  }
}

TEST(TwoBoneIkTest, AStraightLimbBendsAboutItsHinge) {
  const TwoBoneLimb leg{
      .begin = {0, 1, 0}, .middle = {0, .5, 0}, .end = {0, 0, 0}, .hinge = {1, 0, 0}};
  const Solved solved = Apply(leg, SolveTwoBone(leg, {0, .3, 0}));
  EXPECT_LT((solved.end - Eigen::Vector3d(0, .3, 0)).norm(), 1e-9);
  EXPECT_GT(solved.middle.z(), .2);  // the knee goes to the front
}

TEST(TwoBoneIkTest, AKneePastStraightBendsTheRightWay) {
  const TwoBoneLimb leg{
      .begin = {0, 1, 0}, .middle = {0, .5, -.05}, .end = {0, 0, 0}, .hinge = {1, 0, 0}};
  const Solved solved = Apply(leg, SolveTwoBone(leg, {0, .3, 0}));
  EXPECT_LT((solved.end - Eigen::Vector3d(0, .3, 0)).norm(), 1e-9);
  EXPECT_GT(solved.middle.z(), .2);
}

TEST(TwoBoneIkTest, OutOfReachItPointsToTheGoal) {
  const TwoBoneLimb leg{
      .begin = {0, 1, 0}, .middle = {0, .5, .1}, .end = {0, 0, 0}, .hinge = {1, 0, 0}};
  const TwoBoneTurns turns = SolveTwoBone(leg, {3, 1, 0});
  EXPECT_FALSE(turns.reached);
  const Solved solved = Apply(leg, turns);
  EXPECT_LT((solved.end - leg.begin).normalized().cross(Eigen::Vector3d::UnitX()).norm(), 1e-9);
  EXPECT_FALSE(SolveTwoBone(leg, leg.begin).reached);
}

TEST(TwoBoneIkTest, ALimbWithoutLengthStays) {
  const TwoBoneLimb none{
      .begin = {0, 0, 0}, .middle = {0, 0, 0}, .end = {0, 1, 0}, .hinge = {1, 0, 0}};
  EXPECT_TRUE(SolveTwoBone(none, {1, 0, 0}).upper.isIdentity());
}

}  // namespace
}  // namespace pleat
