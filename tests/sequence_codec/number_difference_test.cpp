#include "number_difference.h"

#include <gtest/gtest.h>

#include "pleat/base/random.h"
#include "support/hostile_bytes.h"

namespace pleat {
namespace {

TEST(NumberDifferenceTest, DifferencesOfEverySizeRoundTripInEveryContext) {
  Random random(1);
  std::vector<int> deltas = {0, 1, -1, 2, -2, 3, -3, (1 << 27) - 1, -((1 << 27) - 1)};
  for (int i = 0; i < 4000; ++i) {
    deltas.push_back(random.UniformInt(1 << random.UniformInt(27)) *
                     (random.UniformInt(2) == 0 ? 1 : -1));
  }
  BinaryCoder encoder = BinaryCoder::ForEncoding();
  NumberDifference writer;
  for (size_t i = 0; i < deltas.size(); ++i) {
    ASSERT_EQ(writer.Code(&encoder, deltas[i], static_cast<int>(i % 16)), deltas[i]);
  }
  const std::string bytes = encoder.Finish();
  BinaryCoder decoder = BinaryCoder::ForDecoding(bytes);
  NumberDifference reader;
  for (size_t i = 0; i < deltas.size(); ++i) {
    ASSERT_EQ(reader.Code(&decoder, 0, static_cast<int>(i % 16)), deltas[i]) << i;
  }
  EXPECT_FALSE(decoder.overrun());
}

size_t SizeOf(const std::vector<int>& deltas) {
  BinaryCoder encoder = BinaryCoder::ForEncoding();
  NumberDifference writer;
  for (const int delta : deltas) writer.Code(&encoder, delta, 0);
  return encoder.Finish().size();
}

TEST(NumberDifferenceTest, StepsOfOneAreNearlyFreeAndNoiseCostsItsBits) {
  EXPECT_LT(SizeOf(std::vector<int>(8000, 1)), 100u);
  Random random(2);
  std::vector<int> noise;
  for (int i = 0; i < 8000; ++i) noise.push_back(random.UniformInt(2048) - 1024);
  EXPECT_NEAR(static_cast<double>(SizeOf(noise)), 8000 * 11 / 8., 8000 * 11 / 8. * .05);
}

// Any bytes give numbers within range or the mark of damage: nothing else may come out.
TEST(NumberDifferenceTest, DamagedCodeGivesNumbersInRangeOrTheMark) {
  Random random(3);
  int num_damaged = 0;
  for (int round = 0; round < 300; ++round) {
    std::string bytes;
    for (int i = 0; i < 40; ++i) bytes.push_back(static_cast<char>(random.NextBits()));
    if (round % 2 == 0) bytes.assign(40, round % 4 == 0 ? '\0' : '\xff');
    BinaryCoder decoder = BinaryCoder::ForDecoding(bytes);
    NumberDifference reader;
    for (int i = 0; i < 60; ++i) {
      const int delta = reader.Code(&decoder, 0, i % 16);
      if (delta == NumberDifference::kDamaged) {
        ++num_damaged;
        break;
      }
      ASSERT_LE(std::abs(static_cast<int64_t>(delta)), int64_t{1} << 28);
    }
  }
  EXPECT_GT(num_damaged, 0);
}

}  // namespace
}  // namespace pleat
