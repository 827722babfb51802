#include "footwork.h"

#include <gtest/gtest.h>

#include <cmath>

#include "pleat/base/random.h"
#include "pleat/skeleton/human_template.h"

namespace pleat {
namespace {

using Eigen::Vector3d;

// A straight walk at constant speed, one cycle per 25 frames.
Course StraightWalk(int num_frames, double liveliness = 1) {
  Course course;
  for (int t = 0; t < num_frames; ++t) {
    course.cycles.push_back(t / 25.);
    course.liveliness.push_back(liveliness);
    course.path.emplace_back(0, 0, .02 * t);
    course.heading.push_back(0);
    course.lift.push_back(.04);
    for (auto& offsets : course.offsets) offsets.push_back(Vector3d::Zero());
  }
  return course;
}

TEST(FootworkTest, AFootInItsStanceDoesNotSlide) {
  const Course course = StraightWalk(200);
  const Footwork footwork(HumanTemplate(), course, 0);  // without heel rise the ankle stays, too
  for (int side = 0; side < 2; ++side) {
    int num_standing = 0;
    for (int t = 1; t < 150; ++t) {
      const auto part = [&](int frame) {
        const double position = course.cycles[frame] + Footwork::kStart[side];
        return position - std::floor(position);
      };
      if (part(t) > Footwork::kStance || part(t) < part(t - 1)) continue;
      ++num_standing;
      EXPECT_LT((footwork.At(side, t).ankle - footwork.At(side, t - 1).ankle).norm(), 1e-12)
          << side << " " << t;
    }
    EXPECT_NEAR(num_standing, 150 * Footwork::kStance, 15);
  }
}

TEST(FootworkTest, FeetNeverJumpAndKeepUpWithTheHips) {
  const Course course = StraightWalk(200);
  const Footwork footwork(HumanTemplate(), course, .5);
  for (int side = 0; side < 2; ++side) {
    for (int t = 1; t < 150; ++t) {
      const FootTarget now = footwork.At(side, t), before = footwork.At(side, t - 1);
      EXPECT_LT((now.ankle - before.ankle).norm(), .15) << t;
      EXPECT_LT(std::abs(now.pitch - before.pitch), .3) << t;
      EXPECT_LT(std::abs(now.ankle.z() - course.path[t].z()), .4) << t;
    }
  }
}

TEST(FootworkTest, StandingFeetStayWhereTheRestPoseHasThem) {
  Course course = StraightWalk(30, 0);
  for (double& cycles : course.cycles) cycles = 0;
  for (Vector3d& at : course.path) at.setZero();
  const Footwork footwork(HumanTemplate(), course, .5);
  for (int t = 0; t < 30; ++t) {
    EXPECT_LT((footwork.At(0, t).ankle - HumanTemplate().rest_position(kLeftFoot)).norm(), 1e-12);
    EXPECT_LT((footwork.At(1, t).ankle - HumanTemplate().rest_position(kRightFoot)).norm(), 1e-12);
    EXPECT_EQ(footwork.At(0, t).pitch, 0);
  }
}

class SolveLegTest : public testing::Test {
 protected:
  // Where the ankle goes with these angles, from the hip.
  Vector3d Reach(const LegAngles& angles) const {
    return angles.Thigh() * (thigh_ + angles.Knee() * shin_);
  }

  const Vector3d thigh_ =
      HumanTemplate().rest_position(kLeftLowerLeg) - HumanTemplate().rest_position(kLeftUpperLeg);
  const Vector3d shin_ =
      HumanTemplate().rest_position(kLeftFoot) - HumanTemplate().rest_position(kLeftLowerLeg);
};

TEST_F(SolveLegTest, TheAnkleArrivesWhereItCan) {
  Random random(1);
  for (int round = 0; round < 300; ++round) {
    const LegAngles truth{.flexion = random.Uniform(-.5, 1.2),
                          .abduction = random.Uniform(-.4, .4),
                          .knee = random.Uniform(.2, 2)};
    const Vector3d ankle = Reach(truth);
    const LegAngles solved = SolveLeg(thigh_, shin_, ankle);
    EXPECT_LT((Reach(solved) - ankle).norm(), 1e-9) << round;
    EXPECT_GE(solved.knee, 0);  // never bends backward
    EXPECT_NEAR(solved.knee, truth.knee, 1e-6);
  }
}

TEST_F(SolveLegTest, TheRestPoseIsNoMotion) {
  const LegAngles angles = SolveLeg(thigh_, shin_, thigh_ + shin_);
  EXPECT_LT((Reach(angles) - (thigh_ + shin_)).norm(), 1e-9);
}

TEST_F(SolveLegTest, WhatIsTooFarIsPointedAtWithAStretchedLeg) {
  for (const Vector3d& direction :
       {Vector3d(0, -1, 0), Vector3d(.3, -1, .4), Vector3d(-.2, -1, -.3)}) {
    const Vector3d ankle = 3 * direction;
    const Vector3d reached = Reach(SolveLeg(thigh_, shin_, ankle));
    EXPECT_LT((reached.normalized() - ankle.normalized()).norm(), .02);
    EXPECT_NEAR(reached.norm(), thigh_.norm() + shin_.norm(), .01);
  }
  // The hip itself: nothing to reach for, but no NaN either.
  EXPECT_TRUE(Reach(SolveLeg(thigh_, shin_, Vector3d::Zero())).allFinite());
}

}  // namespace
}  // namespace pleat
