// Scalar functions that shape, motion and skirt are made of.
#include "smooth_noise.h"

#include <gtest/gtest.h>

#include <cmath>

#include "interpolation.h"

namespace pleat {
namespace {

TEST(SmoothNoiseTest, LiesMostlyWithinOneAndHasNoMeanOfItsOwn) {
  Random random(1);
  double sum = 0;
  int num_within = 0, num_times = 0;
  for (int signal = 0; signal < 20; ++signal) {
    const SmoothNoise noise(&random, 2);
    for (double t = 0; t < 200; t += .37, ++num_times) {
      const double value = noise(t);
      sum += value;
      num_within += std::abs(value) <= 1;
      EXPECT_LE(std::abs(value), 5 / 2.4);  // five sines at once
    }
  }
  EXPECT_GT(num_within, .8 * num_times);
  EXPECT_LT(std::abs(sum / num_times), .05);
}

// The fastest of its waves has .55 of the mean period: that bounds every derivative.
TEST(SmoothNoiseTest, NeitherStepsNorBendsFasterThanItsFastestWave) {
  for (const double period_s : {.5, 2., 30.}) {
    Random random(2);
    const SmoothNoise noise(&random, period_s);
    const double fastest = 2 * M_PI / (.55 * period_s), step = 1e-3 * period_s;
    double largest_slope = 0;
    for (double t = 0; t < 20 * period_s; t += .05 * period_s) {
      const double slope = (noise(t + step) - noise(t - step)) / (2 * step);
      const double bend = (noise(t + step) - 2 * noise(t) + noise(t - step)) / (step * step);
      EXPECT_LE(std::abs(slope), 5 / 2.4 * fastest);
      EXPECT_LE(std::abs(bend), 5 / 2.4 * fastest * fastest + 1e-6);
      largest_slope = std::max(largest_slope, std::abs(slope));
    }
    EXPECT_GT(largest_slope * period_s, 1);  // but it moves within a period
  }
}

TEST(SmoothNoiseTest, TheRandomSourceDecidesIt) {
  Random a(3), b(3), c(4);
  const SmoothNoise first(&a, 1), same(&b, 1), other(&c, 1), next(&a, 1);
  EXPECT_EQ(first(.7), same(.7));
  EXPECT_NE(first(.7), other(.7));
  EXPECT_NE(first(.7), next(.7));
}

TEST(SmoothstepTest, RisesFromZeroToOneWithFlatEnds) {
  EXPECT_EQ(Smoothstep(2, 4, -1e9), 0);
  EXPECT_EQ(Smoothstep(2, 4, 2), 0);
  EXPECT_EQ(Smoothstep(2, 4, 3), .5);
  EXPECT_EQ(Smoothstep(2, 4, 4), 1);
  EXPECT_EQ(Smoothstep(2, 4, 1e9), 1);
  double last = 0;
  for (double x = 2; x <= 4; x += .01) {
    const double value = Smoothstep(2, 4, x);
    EXPECT_GE(value, last);
    EXPECT_NEAR(value + Smoothstep(2, 4, 6 - x), 1, 1e-12);  // symmetric about the middle
    last = value;
  }
  EXPECT_LT(Smoothstep(2, 4, 2.001), 1e-5);
  EXPECT_GT(Smoothstep(2, 4, 3.999), 1 - 1e-5);
}

}  // namespace
}  // namespace pleat
