#include "skirt_dynamics.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "performer_motion.h"
#include "pleat/skeleton/human_template.h"
#include "support/status_matchers.h"

namespace pleat {
namespace {

constexpr double kGravity = 9.81 / 1.7;  // body heights per second squared
constexpr int kNumParticles = SkirtDynamics::kNumStrands * SkirtDynamics::kNumRings;

class SkirtDynamicsTest : public testing::Test {
 protected:
  PoseTrack Still(int num_frames) const {
    return PoseTrack::FromValid({.fps = 30,
                                 .poses = std::vector<Pose>(static_cast<size_t>(num_frames),
                                                            Pose::Rest(shape_.skeleton()))});
  }

  const CharacterShape shape_{1};
  SkirtDynamics dynamics_{shape_};
};

TEST_F(SkirtDynamicsTest, TheRestShapeIsAtRest) {
  PLEAT_ASSERT_OK_AND_ASSIGN(const auto displacements, dynamics_.Simulate(Still(60), kGravity, {}));
  ASSERT_EQ(displacements.size(), 60u);
  for (const Eigen::Matrix3Xf& frame : displacements) {
    ASSERT_EQ(frame.cols(), kNumParticles);
    // Only where a leg pushes may the bell give way.
    EXPECT_LT(frame.colwise().norm().maxCoeff(), .03f);
  }
  EXPECT_LT((displacements[59] - displacements[58]).colwise().norm().maxCoeff(), 1e-3f);
}

TEST_F(SkirtDynamicsTest, SwingsWithTheBodyWithinItsLimitAndTheWaistIsPinned) {
  const PoseTrack track = GenerateMotion(shape_.skeleton(), {.num_frames = 120});
  PLEAT_ASSERT_OK_AND_ASSIGN(const auto displacements, dynamics_.Simulate(track, kGravity, {}));
  float largest = 0;
  for (const Eigen::Matrix3Xf& frame : displacements) {
    EXPECT_TRUE(frame.allFinite());
    EXPECT_LT(frame.leftCols(SkirtDynamics::kNumStrands).cwiseAbs().maxCoeff(), 1e-6f);
    largest =
        std::max(largest, frame.rightCols(SkirtDynamics::kNumStrands).colwise().norm().maxCoeff());
  }
  EXPECT_GT(largest, .03f);
  EXPECT_LT(largest, 2 * SkirtDynamics::kMaxDisplacement);
}

TEST_F(SkirtDynamicsTest, TheSameMotionGivesTheSameSwing) {
  const PoseTrack track = GenerateMotion(shape_.skeleton(), {.num_frames = 20});
  SkirtDynamics other(shape_);
  EXPECT_EQ(dynamics_.Simulate(track, kGravity, {}).value(),
            other.Simulate(track, kGravity, {}).value());
  // A second run begins anew.
  EXPECT_EQ(dynamics_.Simulate(track, kGravity, {}).value(),
            other.Simulate(track, kGravity, {}).value());
}

// Weights of a lookup reproduce constants everywhere and the particles at their own places.
TEST_F(SkirtDynamicsTest, LookupsInterpolateTheParticles) {
  const SkirtShape& skirt = shape_.skirt();
  for (double theta = -3; theta < 3; theta += .37) {
    for (const double s : {0., .13, .5, .98, 1.}) {
      const SkirtSample sample = dynamics_.Locate(skirt.Point(theta, s));
      double sum = 0;
      for (int i = 0; i < 16; ++i) {
        ASSERT_GE(sample.ids[i], 0);
        ASSERT_LT(sample.ids[i], kNumParticles);
        sum += sample.weights[i];
      }
      EXPECT_NEAR(sum, 1, 1e-6) << theta << " " << s;
    }
  }
  for (const int ring : {1, 7, SkirtDynamics::kNumRings - 1}) {
    for (const int strand : {0, 5, 40}) {
      const double theta = 2 * std::numbers::pi * (strand + 1e-9) / SkirtDynamics::kNumStrands;
      const SkirtSample sample =
          dynamics_.Locate(skirt.Point(theta, ring / (SkirtDynamics::kNumRings - 1.0)));
      const int wanted = ring * SkirtDynamics::kNumStrands + strand;
      double weight = 0;
      for (int i = 0; i < 16; ++i) weight += sample.ids[i] == wanted ? sample.weights[i] : 0;
      EXPECT_NEAR(weight, 1, 1e-4) << ring << " " << strand;
    }
  }
}

TEST_F(SkirtDynamicsTest, CancellationIsHeard) {
  EXPECT_THAT(dynamics_.Simulate(Still(3), kGravity, Progress(nullptr, [] { return true; })),
              HasStatus(absl::StatusCode::kCancelled, testing::_));
}

}  // namespace
}  // namespace pleat
