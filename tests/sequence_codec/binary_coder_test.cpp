#include "binary_coder.h"

#include <gtest/gtest.h>

#include <vector>

#include "pleat/base/random.h"

namespace pleat {
namespace {

TEST(BinaryCoderTest, BitsOfAnyProbabilityRoundTrip) {
  for (uint64_t seed = 1; seed <= 300; ++seed) {
    Random random(seed);
    const int count = random.UniformInt(400);
    std::vector<int> bits, probabilities;
    BinaryCoder encoder = BinaryCoder::ForEncoding();
    for (int i = 0; i < count; ++i) {
      probabilities.push_back(1 + random.UniformInt(BinaryCoder::kOne - 1));
      bits.push_back(random.UniformInt(BinaryCoder::kOne) < probabilities.back());
      encoder.Code(bits.back(), probabilities.back());
    }
    const std::string bytes = encoder.Finish();
    BinaryCoder decoder = BinaryCoder::ForDecoding(bytes);
    for (int i = 0; i < count; ++i) ASSERT_EQ(decoder.Code(0, probabilities[i]), bits[i]) << seed;
    EXPECT_FALSE(decoder.overrun());
  }
}

TEST(BinaryCoderTest, CostIsNearTheEntropy) {
  Random random(7);
  BinaryCoder encoder = BinaryCoder::ForEncoding();
  constexpr int kCount = 80'000, kProbability = BinaryCoder::kOne / 16;
  for (int i = 0; i < kCount; ++i) {
    encoder.Code(random.UniformInt(BinaryCoder::kOne) < kProbability, kProbability);
  }
  const double entropy_bytes = kCount * 0.33729 / 8;
  EXPECT_NEAR(static_cast<double>(encoder.Finish().size()), entropy_bytes, 0.02 * entropy_bytes);
}

TEST(BinaryCoderTest, RawBitsRoundTripAndTheEndIsSeen) {
  BinaryCoder encoder = BinaryCoder::ForEncoding();
  encoder.CodeBits(0xdeadbeef, 32);
  encoder.CodeBits(5, 3);
  const std::string bytes = encoder.Finish();
  BinaryCoder decoder = BinaryCoder::ForDecoding(bytes);
  EXPECT_EQ(decoder.CodeBits(0, 32), 0xdeadbeefu);
  EXPECT_EQ(decoder.CodeBits(0, 3), 5u);
  EXPECT_FALSE(decoder.overrun());
  for (int i = 0; i < 100; ++i) decoder.CodeBits(0, 32);
  EXPECT_TRUE(decoder.overrun());
}

}  // namespace
}  // namespace pleat
