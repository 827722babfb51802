#include "cli/show/time_text.h"

#include <gtest/gtest.h>

namespace pleat {
namespace {

const absl::Time kMoment = absl::FromUnixMillis(1'796'072'709'123);

TEST(TimeText, TimesAreThoseOfUtc) {
  EXPECT_EQ(TimeText(kMoment), "2026-11-30 21:05:09");
  EXPECT_EQ(TimeForJson(kMoment), "2026-11-30T21:05:09.123Z");
  EXPECT_EQ(TimeText(std::nullopt), "");
}

TEST(TimeText, APinIsStrongerThanATimeToLive) {
  EXPECT_EQ(KeptUntilText({}), "");
  EXPECT_EQ(KeptUntilText({.expires = kMoment}), "2026-11-30 21:05:09");
  EXPECT_EQ(KeptUntilText({.expires = kMoment, .pinned = true}), "pinned");
}

TEST(TimeText, DurationsAreAsExactAsTheyAreShort) {
  EXPECT_EQ(DurationText(kMoment, kMoment + absl::Microseconds(1'234'567)), "1.234s");
  EXPECT_EQ(DurationText(kMoment, kMoment + absl::Seconds(3723.9)), "1h2m3s");
  EXPECT_EQ(DurationText(std::nullopt, kMoment), "");
  EXPECT_EQ(DurationText(kMoment, std::nullopt), "");
}

}  // namespace
}  // namespace pleat
