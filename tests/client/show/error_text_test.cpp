#include "cli/show/error_text.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace pleat {
namespace {

using ::testing::ElementsAre;

ErrorSummary SomeError() {
  ErrorSummary error;
  error.mean_percent = .12345;
  error.rms_percent = .2;
  error.p95_percent = 1.0004;
  error.max_percent = 12.5;
  error.mean_mm = 3.456;
  return error;
}

TEST(ErrorTextTest, RowsHavePercentsAndMillimetersOfTheDiagonal) {
  EXPECT_THAT(ErrorTableHeader("clip"),
              ElementsAre("clip", "mean %", "rms %", "p95 %", "max %", "mean mm", "max mm"));
  // 12.5 % of two meters are 250 mm.
  EXPECT_THAT(ErrorTableRow("hybrid", SomeError(), 2),
              ElementsAre("hybrid", "0.123", "0.200", "1.000", "12.50", "3.46", "250.0"));
}

TEST(ErrorTextTest, HeadersAndRowsHaveTheSameLength) {
  EXPECT_EQ(ErrorTableHeader("x").size(), ErrorTableRow("x", SomeError(), 1).size());
  EXPECT_EQ(MotionTableHeader("x").size(), MotionTableRow("x", SomeError()).size());
}

TEST(ErrorTextTest, MotionIsADashWhereNoFramesFollowEachOther) {
  ErrorSummary error = SomeError();
  EXPECT_THAT(MotionTableRow("test", error),
              ElementsAre("test", "0.123", "0.200", "1.000", "12.50", "3.46", "-", "-", "-"));
  error.num_motion_frames = 9;
  error.motion_mean_percent = .0125;
  error.motion_mean_mm = .256;
  EXPECT_THAT(MotionTableRow("test", error), ElementsAre("test", "0.123", "0.200", "1.000", "12.50",
                                                         "3.46", "0.013", "0.26", "-"));
  error.num_jitter_frames = 8;
  error.jitter_mm = 1.5;
  EXPECT_EQ(MotionTableRow("test", error).back(), "1.50");
}

TEST(ErrorTextTest, ValidationNamesEveryLearnerThatWasTried) {
  LearnerValidation validation;
  EXPECT_EQ(ValidationText(validation), "");
  validation.num_held_out_frames = 20;
  validation.mean_percent = {{"gp", .5}, {"ridge", .75}};
  EXPECT_EQ(ValidationText(validation),
            "learner chosen on 20 training frames that none of them saw: gp 0.500 % ridge 0.750 "
            "%\n");
}

}  // namespace
}  // namespace pleat
