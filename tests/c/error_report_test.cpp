#include "error_report.h"

#include <gtest/gtest.h>

#include <cstring>
#include <new>
#include <stdexcept>
#include <string>

namespace pleat {
namespace {

TEST(ErrorReportTest, CodesAreThoseOfTheStatus) {
  pleat_error error{.code = -1, .message = "before"};
  EXPECT_EQ(Report(absl::OkStatus(), &error), PLEAT_OK);
  EXPECT_EQ(error.code, PLEAT_OK);
  EXPECT_STREQ(error.message, "");
  EXPECT_EQ(Report(absl::DataLossError("cut off"), &error), PLEAT_DATA_LOSS);
  EXPECT_EQ(error.code, PLEAT_DATA_LOSS);
  EXPECT_STREQ(error.message, "cut off");
  EXPECT_EQ(Report(absl::UnauthenticatedError("who"), nullptr), PLEAT_UNAUTHENTICATED);
  EXPECT_EQ(Report(absl::OutOfRangeError("end"), nullptr), PLEAT_OUT_OF_RANGE);
}

// Longer words are cut between characters and always end with a zero.
TEST(ErrorReportTest, LongMessagesAreCutAtAWholeCharacter) {
  for (size_t before = 1000; before < 1025; ++before) {
    std::string words(before, 'x');
    for (int i = 0; i < 20; ++i) words += "\u00e9";  // two bytes
    pleat_error error;
    Report(absl::InternalError(words), &error);
    const size_t length = std::strlen(error.message);
    ASSERT_LT(length, sizeof(error.message));
    ASSERT_GE(length, sizeof(error.message) - 3);
    EXPECT_EQ(words.compare(0, length, error.message), 0);
    EXPECT_TRUE(length <= before || (length - before) % 2 == 0) << before;
  }
}

TEST(ErrorReportTest, ExceptionsBecomeCodes) {
  pleat_error error;
  const auto thrown = [&](auto exception) {
    return Guarded(&error, [&]() -> absl::Status { throw exception; });
  };
  EXPECT_EQ(thrown(std::bad_alloc()), PLEAT_RESOURCE_EXHAUSTED);
  EXPECT_EQ(thrown(std::length_error("too long")), PLEAT_RESOURCE_EXHAUSTED);
  EXPECT_EQ(thrown(std::runtime_error("words")), PLEAT_INTERNAL);
  EXPECT_STREQ(error.message, "words");
  EXPECT_EQ(thrown(7), PLEAT_INTERNAL);
  EXPECT_EQ(Guarded(nullptr, []() -> absl::Status { throw 7; }), PLEAT_INTERNAL);
}

TEST(ErrorReportTest, AStructMayBeLargerThanTheFirstAndNotSmaller) {
  EXPECT_TRUE(CheckStructSize("pleat_query", 80, 80).ok());
  EXPECT_TRUE(CheckStructSize("pleat_query", 88, 80).ok());
  const absl::Status small = CheckStructSize("pleat_query", 0, 80);
  EXPECT_EQ(small.code(), absl::StatusCode::kInvalidArgument);
  EXPECT_NE(small.message().find("sizeof(pleat_query)"), absl::string_view::npos);
}

}  // namespace
}  // namespace pleat
