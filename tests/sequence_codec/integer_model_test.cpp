#include "integer_model.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "pleat/base/random.h"

namespace pleat {
namespace {

TEST(IntegerModelTest, NumbersOfAllSizesRoundTrip) {
  Random random(3);
  std::vector<int> values, contexts;
  for (int i = 0; i < 5000; ++i) {
    const int bits = random.UniformInt(27);
    values.push_back(random.UniformInt(1 << bits) * (random.UniformInt(2) ? 1 : -1));
    contexts.push_back(random.UniformInt(4));
  }
  BinaryCoder encoder = BinaryCoder::ForEncoding();
  IntegerModel<2> writer({4, 1}, 2);
  for (size_t i = 0; i < values.size(); ++i) {
    writer.CodeSigned(&encoder, values[i], {contexts[i], 0}, contexts[i] & 1);
  }
  const std::string bytes = encoder.Finish();
  BinaryCoder decoder = BinaryCoder::ForDecoding(bytes);
  IntegerModel<2> reader({4, 1}, 2);
  for (size_t i = 0; i < values.size(); ++i) {
    ASSERT_EQ(reader.CodeSigned(&decoder, 0, {contexts[i], 0}, contexts[i] & 1), values[i]) << i;
  }
  EXPECT_FALSE(decoder.overrun());
}

// A context that tells everything makes numbers nearly free; one that tells nothing does not hurt.
TEST(IntegerModelTest, LearnsWhichContextTells) {
  Random random(4);
  BinaryCoder encoder = BinaryCoder::ForEncoding();
  IntegerModel<2> model({3, 5}, 1);
  for (int i = 0; i < 20'000; ++i) {
    const int value = random.UniformInt(3);
    model.CodeUnsigned(&encoder, value, {value, random.UniformInt(5)}, 0);
  }
  EXPECT_LT(encoder.Finish().size(), 400u);  // 3963 bytes without a context
}

TEST(IntegerModelTest, TablesAreInverse) {
  const LogisticTables& tables = LogisticTables::Get();
  for (int p = 1; p < 4096; ++p) {
    EXPECT_GE(tables.stretch[p], tables.stretch[p - 1]);
    const double exact = 256 * std::log((p + 0.5) / (4095.5 - p));
    EXPECT_NEAR(tables.stretch[p], std::clamp(exact, -2048.0, 2047.0), 1 + 0.003 * std::abs(exact))
        << p;
  }
  for (int x = -2047; x < 2048; ++x) {
    const double exact = 65536 / (1 + std::exp(-x / 256.0));
    EXPECT_NEAR(tables.squash[x + 2048], exact, 0.6) << x;
  }
}

TEST(IntegerModelTest, MagnitudeClassesGrow) {
  EXPECT_EQ(MagnitudeClass(0), 0);
  EXPECT_EQ(MagnitudeClass(1), 1);
  EXPECT_EQ(MagnitudeClass(16), 4);
  EXPECT_EQ(MagnitudeClass(399), 10);
  EXPECT_EQ(MagnitudeClass(1'000'000), kNumMagnitudeClasses - 1);
}

}  // namespace
}  // namespace pleat
