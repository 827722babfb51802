#include "cli/io/frame_rate.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "cli/exit_code.h"
#include "support/status_matchers.h"

namespace pleat {
namespace {

TEST(FrameRate, ParsesWhatPeopleWrite) {
  const auto expect = [](const char* text, int numerator, int denominator) {
    PLEAT_ASSERT_OK_AND_ASSIGN(const FrameRate rate, ParseFrameRate(text));
    EXPECT_EQ(rate.numerator, numerator) << text;
    EXPECT_EQ(rate.denominator, denominator) << text;
  };
  expect("30", 30, 1);
  expect("29.97", 2997, 100);
  expect("23.976", 2997, 125);
  expect("30000/1001", 30000, 1001);
  expect("0.5", 1, 2);
}

TEST(FrameRate, FormatIsTheInverse) {
  for (const char* text : {"30", "29.97", "23.976", "30000/1001", "0.5", "1234.567"}) {
    PLEAT_ASSERT_OK_AND_ASSIGN(const FrameRate rate, ParseFrameRate(text));
    EXPECT_EQ(FormatFrameRate(rate), text);
  }
}

TEST(FrameRate, RefusesTheRest) {
  for (const char* text : {"", "x", "0", "-30", "nan", "inf", "30/0", "30/1/1", "1e9", "0.00001",
                           "29.97003", "99999999999/1", "-30/-1"}) {
    EXPECT_TRUE(IsUsageError(ParseFrameRate(text).status())) << text;
  }
}

}  // namespace
}  // namespace pleat
