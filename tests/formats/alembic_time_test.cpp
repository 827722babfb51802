#include "alembic_time.h"

#include <limits>

#include "support/hostile_bytes.h"
#include "support/status_matchers.h"

namespace pleat {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

std::string TimesBytes(const AlembicTimeSampling& sampling) {
  ByteWriter writer;
  WriteTimeSampling(sampling, 7, &writer);
  return writer.Release();
}

const AlembicTimeSampling kUniformTimes = {0.04, {0.4}};
const AlembicTimeSampling kShutterTimes = {0.5, {1, 1.125}};
const AlembicTimeSampling kListedTimes = {kAcyclicSeconds, {0, 0.25, 1}};

AlembicTimes TimesOf(const AlembicTimeSampling& sampling, int num_samples) {
  return {.sampling = &sampling, .num_samples = num_samples};
}

TEST(AlembicTimeTest, SamplingsRoundTrip) {
  const std::string bytes =
      TimesBytes(kUniformTimes) + TimesBytes(kShutterTimes) + TimesBytes(kListedTimes);
  PLEAT_ASSERT_OK_AND_ASSIGN(const std::vector<AlembicTimeSampling> read,
                             ParseTimeSamplings(bytes));
  EXPECT_THAT(read, ElementsAre(kUniformTimes, kShutterTimes, kListedTimes));
  ForEachTruncation(bytes, [](const std::string& damaged) {
    const auto samplings = ParseTimeSamplings(damaged);
    EXPECT_TRUE(!samplings.ok() || samplings->size() < 3);
  });
}

TEST(AlembicTimeTest, ImpossibleTimesAreRefused) {
  const double infinity = std::numeric_limits<double>::infinity();
  EXPECT_THAT(ParseTimeSamplings(TimesBytes({1, {}})), HasStatus(kInvalid, HasSubstr("no time")));
  EXPECT_THAT(ParseTimeSamplings(TimesBytes({0, {0}})), HasStatus(kInvalid, HasSubstr("cycle")));
  EXPECT_THAT(ParseTimeSamplings(TimesBytes({-1, {0}})), HasStatus(kInvalid, HasSubstr("cycle")));
  EXPECT_THAT(ParseTimeSamplings(TimesBytes({infinity, {0}})), HasStatus(kInvalid, HasSubstr("")));
  EXPECT_THAT(ParseTimeSamplings(TimesBytes({1, {infinity}})),
              HasStatus(kInvalid, HasSubstr("not finite")));
  EXPECT_THAT(ParseTimeSamplings(TimesBytes({kAcyclicSeconds, {0, 0}})),
              HasStatus(kInvalid, HasSubstr("not after")));
  EXPECT_THAT(ParseTimeSamplings(TimesBytes({1, {0, 1.5}})),
              HasStatus(kInvalid, HasSubstr("cycle of 1 s")));
}

TEST(AlembicTimeTest, EveryKindGivesItsTimes) {
  EXPECT_THAT(TimesOf(kUniformTimes, 3).All(), ElementsAre(0.4, 0.4 + 0.04, 0.4 + 0.04 * 2));
  EXPECT_THAT(TimesOf(kShutterTimes, 5).All(), ElementsAre(1, 1.125, 1.5, 1.625, 2));
  EXPECT_THAT(TimesOf(kListedTimes, 3).All(), ElementsAre(0, 0.25, 1));
  EXPECT_THAT(CheckTimes(TimesOf(kListedTimes, 3)), IsOk());
  EXPECT_THAT(CheckTimes(TimesOf(kListedTimes, 4)),
              HasStatus(kInvalid, HasSubstr("4 samples but only 3")));
}

TEST(AlembicTimeTest, FindsTheSamplesAround) {
  const AlembicTimes times = TimesOf(kListedTimes, 3);
  const auto find = [&](double seconds) { return FindTime(times, seconds); };
  EXPECT_EQ(find(-5).after, 0);
  EXPECT_EQ(find(0).before, 0);
  EXPECT_EQ(find(0.249999).before, 1);  // within 10 microseconds
  EXPECT_EQ(find(0.250009).after, 1);
  EXPECT_EQ(find(9).before, 2);
  const TimePlace between = find(0.4375);
  EXPECT_EQ(between.before, 1);
  EXPECT_EQ(between.after, 2);
  EXPECT_DOUBLE_EQ(between.weight, 0.25);
}

TEST(AlembicTimeTest, SameTimesNeedNotBeTheSameSampling) {
  const AlembicTimeSampling twenty_five = {0.04, {0}};
  const AlembicTimeSampling listed = {kAcyclicSeconds, {0, 0.040001, 0.08}};
  EXPECT_TRUE(AreSameTimes(TimesOf(twenty_five, 3), TimesOf(listed, 3)));
  EXPECT_FALSE(AreSameTimes(TimesOf(twenty_five, 2), TimesOf(listed, 3)));
  EXPECT_FALSE(AreSameTimes(TimesOf(twenty_five, 3), TimesOf(kListedTimes, 3)));
}

TEST(AlembicTimeTest, FractionsComeBackExactly) {
  for (const FrameRate rate :
       {FrameRate{24, 1}, FrameRate{25, 1}, FrameRate{30, 1}, FrameRate{60, 1}, FrameRate{120, 1},
        FrameRate{24000, 1001}, FrameRate{30000, 1001}, FrameRate{60000, 1001}, FrameRate{1, 1},
        FrameRate{15, 2}, FrameRate{2997, 100}, FrameRate{2997, 125}, FrameRate{1, 3},
        FrameRate{12345, 678}, FrameRate{999983, 999979}, FrameRate{10000, 1}}) {
    const auto read = RateOfStep(static_cast<double>(rate.denominator) / rate.numerator);
    ASSERT_TRUE(read);
    EXPECT_EQ(int64_t{read->numerator} * rate.denominator,
              int64_t{read->denominator} * rate.numerator)
        << rate.numerator << "/" << rate.denominator;
  }
}

TEST(AlembicTimeTest, RoundedStepsMeanTheUsualRates) {
  EXPECT_EQ(RateOfStep(1.0 / 30.0f + 1e-9), (FrameRate{30, 1}));
  EXPECT_EQ(RateOfStep(0.03333333507180214), (FrameRate{30, 1}));  // as a Unity exporter writes
  EXPECT_EQ(RateOfStep(static_cast<float>(1001.0 / 30000)), (FrameRate{30000, 1001}));
  EXPECT_EQ(RateOfStep(0), std::nullopt);
  EXPECT_EQ(RateOfStep(1e-5), std::nullopt);
  EXPECT_EQ(RateOfStep(-1), std::nullopt);
  EXPECT_EQ(RateOfStep(std::numeric_limits<double>::quiet_NaN()), std::nullopt);
}

TEST(AlembicTimeTest, OnlyEvenTimesAreARate) {
  EXPECT_EQ(RateOfTimes({1, 1.04, 1.08, 1.12}), (FrameRate{25, 1}));
  EXPECT_EQ(RateOfTimes({0, 0.041, 0.084, 0.129}), std::nullopt);
  EXPECT_EQ(RateOfTimes({0, 0.5, 0.5625}), std::nullopt);
}

}  // namespace
}  // namespace pleat
