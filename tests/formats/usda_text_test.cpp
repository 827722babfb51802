#include "usda_text.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace pleat {
namespace {

TEST(UsdaTextTest, NamesOfPrimsAreIdentifiers) {
  EXPECT_EQ(PrimName("take 2.b", "x"), "take_2_b");
  EXPECT_EQ(PrimName("2nd", "x"), "_2nd");
  EXPECT_EQ(PrimName("\xc3\xa4rm", "x"), "_rm");
  EXPECT_EQ(PrimName("", "x"), "x");
}

TEST(UsdaTextTest, TextsAreQuotedOnOneLine) {
  EXPECT_EQ(QuotedText("a\"b\\c\nd"), "\"a\\\"b\\\\c d\"");
}

TEST(UsdaTextTest, ValuesAreTheShortestThatReadBack) {
  std::string text;
  const float values[] = {.1f, -0.f, 1e-7f};
  AppendTuple(values, 3, &text);
  AppendIntegers({}, &text);
  AppendIntegers({1, -2}, &text);
  EXPECT_EQ(text, "(0.1, -0, 1e-07)[][1, -2]");
}

TEST(UsdaTextTest, TheHeadSaysSpaceAndTimeline) {
  std::string text;
  AppendUsdaHead(
      {.default_prim = "a", .meters_per_unit = .01, .is_z_up = true, .last_frame = 9, .fps = 25},
      &text);
  EXPECT_EQ(text,
            "#usda 1.0\n(\n    defaultPrim = \"a\"\n    doc = \"Written by Pleat\"\n"
            "    endTimeCode = 9\n    framesPerSecond = 25\n    metersPerUnit = 0.01\n"
            "    startTimeCode = 0\n    timeCodesPerSecond = 25\n    upAxis = \"Z\"\n)\n\n");
}

}  // namespace
}  // namespace pleat
