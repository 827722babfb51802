#include "pleat/base/random.h"

#include <gtest/gtest.h>

namespace pleat {
namespace {

TEST(RandomTest, SameSeedGivesSameNumbers) {
  Random a(7), b(7), c(8);
  bool differs = false;
  for (int i = 0; i < 100; ++i) {
    const uint64_t bits = a.NextBits();
    EXPECT_EQ(bits, b.NextBits());
    differs |= bits != c.NextBits();
  }
  EXPECT_TRUE(differs);
}

TEST(RandomTest, NormalHasUnitMoments) {
  Random random(1);
  double sum = 0, squares = 0;
  const int count = 200000;
  for (int i = 0; i < count; ++i) {
    const double value = random.Normal();
    sum += value;
    squares += value * value;
  }
  EXPECT_NEAR(sum / count, 0, 0.01);
  EXPECT_NEAR(squares / count, 1, 0.02);
}

TEST(RandomTest, UniformIntStaysInRangeAndReachesBothEnds) {
  Random random(3);
  bool first = false, last = false;
  for (int i = 0; i < 1000; ++i) {
    const int value = random.UniformInt(5);
    ASSERT_GE(value, 0);
    ASSERT_LT(value, 5);
    first |= value == 0;
    last |= value == 4;
  }
  EXPECT_TRUE(first && last);
}

}  // namespace
}  // namespace pleat
