#include "frame_times.h"

#include <limits>

#include "support/status_matchers.h"

namespace pleat {
namespace {

std::vector<float> TimesAt(FrameRate rate, int first, int count) {
  std::vector<float> times;
  for (int t = first; t < first + count; ++t) {
    times.push_back(static_cast<float>(static_cast<double>(t) / rate.fps()));
  }
  return times;
}

TEST(FrameTimesTest, RatesComeBackFromRoundedTimes) {
  for (const FrameRate rate : {FrameRate{24, 1}, FrameRate{25, 1}, FrameRate{24000, 1001},
                               FrameRate{30000, 1001}, FrameRate{30, 1}, FrameRate{60000, 1001},
                               FrameRate{120, 1}, FrameRate{7, 1}, FrameRate{1, 1}}) {
    for (const int first : {0, 1, 1001, 86400}) {
      const std::optional<FrameRate> found = RateOfFloatTimes(TimesAt(rate, first, 300));
      ASSERT_TRUE(found) << rate.fps() << " from " << first;
      EXPECT_NEAR(found->fps() / rate.fps(), 1, first > 1001 ? 1e-3 : 1e-9) << first;
    }
    EXPECT_EQ(RateOfFloatTimes(TimesAt(rate, 0, 300)), rate);
  }
}

TEST(FrameTimesTest, UnevenTimesHaveNoRate) {
  EXPECT_EQ(RateOfFloatTimes({0, 0.04f, 0.1f}), std::nullopt);
  EXPECT_EQ(RateOfFloatTimes({0, 0, 0}), std::nullopt);
  EXPECT_EQ(RateOfFloatTimes({1, 0}), std::nullopt);
  EXPECT_EQ(RateOfFloatTimes({0}), std::nullopt);
  EXPECT_EQ(RateOfFloatTimes({0, std::numeric_limits<float>::quiet_NaN()}), std::nullopt);
}

TEST(FrameTimesTest, KeysLieOnTheFramesOfAUsualRate) {
  EXPECT_EQ(RateOfKeys({0, 10 / 24.f, 11 / 24.f, 35 / 24.f}), (FrameRate{24, 1}));
  EXPECT_EQ(RateOfKeys({0, 1 / 60.f, 9 / 60.f}), (FrameRate{60, 1}));
  EXPECT_EQ(RateOfKeys({0, 0.0123f, 0.777f}), std::nullopt);
}

TEST(FrameTimesTest, FrameNumbersAreWholeWhereTheyAreMeant) {
  EXPECT_EQ(FrameNumberAt(1001 / 24.f, {24, 1}), 1001);
  EXPECT_EQ(FrameNumberAt(0.5f, {25, 1}), 12.5);
}

TEST(FrameTimesTest, IntervalsAreThoseOfUsualRatesWholeOnesFirst) {
  EXPECT_EQ(RateOfInterval(.0083333, 1e-6), (FrameRate{120, 1}));
  EXPECT_EQ(RateOfInterval(.042, 5e-4), (FrameRate{24, 1}));
  EXPECT_EQ(RateOfInterval(.0333667, 7e-6), (FrameRate{30000, 1001}));
  EXPECT_EQ(RateOfInterval(.07, 1e-5), std::nullopt);
}

}  // namespace
}  // namespace pleat
