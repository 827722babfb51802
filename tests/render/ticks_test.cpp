#include "ticks.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

namespace pleat {
namespace {

using ::testing::DoubleNear;
using ::testing::Pointwise;

TEST(TicksTest, StepsAreOneTwoOrFive) {
  EXPECT_THAT(RoundTicks(0, 10, 5), Pointwise(DoubleNear(1e-9), {0, 2, 4, 6, 8, 10}));
  EXPECT_THAT(RoundTicks(0, 1, 2), Pointwise(DoubleNear(1e-9), {0., .5, 1.}));
  EXPECT_THAT(RoundTicks(-3, 3, 6), Pointwise(DoubleNear(1e-9), {-3, -2, -1, 0, 1, 2, 3}));
}

TEST(TicksTest, TicksStayInsideAndAreAboutAsManyAsWanted) {
  for (const double low : {-1e4, -.37, 0., 1e-6, 12345.}) {
    for (const double size : {1e-5, .3, 1., 7., 4e6}) {
      for (const int wanted : {1, 3, 5, 10}) {
        const std::vector<double> ticks = RoundTicks(low, low + size, wanted);
        EXPECT_LE(ticks.size(), static_cast<size_t>(wanted) + 1) << low << " " << size;
        EXPECT_GE(2.5 * static_cast<double>(ticks.size() + 1), wanted) << low << " " << size;
        for (size_t i = 0; i < ticks.size(); ++i) {
          EXPECT_GE(ticks[i], low - 1e-6 * size);
          EXPECT_LE(ticks[i], low + size * (1 + 1e-6));
          if (i > 1) {
            EXPECT_NEAR(ticks[i] - ticks[i - 1], ticks[1] - ticks[0], 1e-6 * size);
          }
        }
      }
    }
  }
}

TEST(TicksTest, LabelsHaveTheDigitsOfTheStep) {
  EXPECT_EQ(TickLabel(3, 1), "3");
  EXPECT_EQ(TickLabel(.5, .5), "0.5");
  EXPECT_EQ(TickLabel(2, .5), "2.0");
  EXPECT_EQ(TickLabel(.25, .05), "0.25");
  EXPECT_EQ(TickLabel(3000, 1000), "3000");
  EXPECT_EQ(TickLabel(.002, .001), "0.002");
  EXPECT_EQ(TickLabel(-0.0, .1), "0.0");  // no minus before nothing
}

}  // namespace
}  // namespace pleat
