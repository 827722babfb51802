#include "pleat/stream/stream_header.h"

#include <gtest/gtest.h>

#include <limits>

#include "support/status_matchers.h"

namespace pleat {
namespace {

using ::testing::HasSubstr;

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kInfinity = std::numeric_limits<float>::infinity();

TEST(QuantizationBoxTest, StepsDivideTheEdgeAndBothEndsAreGridPoints) {
  for (int bits = QuantizationBox::kMinBits; bits <= QuantizationBox::kMaxBits; ++bits) {
    const QuantizationBox box{.origin_m = {1, 2, 3}, .range_m = 2.5f, .bits = bits};
    EXPECT_THAT(box.Validate(), IsOk()) << bits;
    EXPECT_DOUBLE_EQ(box.step_m() * ((1 << bits) - 1), 2.5) << bits;
  }
  // What the documentation promises: 12 bits on a person of two meters are about half a millimeter.
  EXPECT_NEAR((QuantizationBox{.range_m = 2, .bits = 12}.step_m()), 5e-4, 2e-5);
}

TEST(QuantizationBoxTest, BitsOutsideTheRangeAreNamedWithTheRange) {
  for (const int bits : {-1, 0, 7, 21, 32, 64}) {
    EXPECT_THAT((QuantizationBox{.bits = bits}.Validate()),
                HasStatus(absl::StatusCode::kInvalidArgument,
                          "position_bits is " + std::to_string(bits) + ", allowed are 8 to 20"));
  }
}

TEST(QuantizationBoxTest, OriginsThatAreNoPointsAreRefusedOnEveryAxis) {
  for (int axis = 0; axis < 3; ++axis) {
    for (const float value : {kNan, kInfinity, -kInfinity, 2e9f, -2e9f}) {
      QuantizationBox box;
      box.origin_m[axis] = value;
      EXPECT_THAT(box.Validate(),
                  HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("not a finite point")))
          << axis << " " << value;
    }
    QuantizationBox box;
    box.origin_m[axis] = -1e9f;  // the limit itself is allowed
    EXPECT_THAT(box.Validate(), IsOk());
  }
}

TEST(QuantizationBoxTest, EdgesThatAreNoLengthsAreRefused) {
  for (const float range_m : {0.f, -1.f, 1e-10f, 2e9f, kNan, kInfinity}) {
    EXPECT_THAT((QuantizationBox{.range_m = range_m}.Validate()),
                HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("allowed is 1e-9 to 1e9")))
        << range_m;
  }
  EXPECT_THAT((QuantizationBox{.range_m = 2e-9f}.Validate()), IsOk());
  EXPECT_THAT((QuantizationBox{.range_m = 9e8f}.Validate()), IsOk());
}

TEST(QuantizationBoxTest, BoxesAreEqualWhenEveryMemberIs) {
  const QuantizationBox box{.origin_m = {1, 2, 3}, .range_m = 2, .bits = 14};
  EXPECT_EQ(box, (QuantizationBox{.origin_m = {1, 2, 3}, .range_m = 2, .bits = 14}));
  EXPECT_FALSE(box == (QuantizationBox{.origin_m = {1, 2, 4}, .range_m = 2, .bits = 14}));
  EXPECT_FALSE(box == (QuantizationBox{.origin_m = {1, 2, 3}, .range_m = 3, .bits = 14}));
  EXPECT_FALSE(box == (QuantizationBox{.origin_m = {1, 2, 3}, .range_m = 2, .bits = 15}));
}

}  // namespace
}  // namespace pleat
