#include "pleat/simd/round_weights.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "pleat/base/random.h"
#include "simd/guarded_buffer.h"

namespace pleat {
namespace {

struct Products {
  GuardedBuffer<float> scales, coefficients;
  explicit Products(int count)
      : scales(static_cast<size_t>(count)), coefficients(static_cast<size_t>(count)) {
    Random random(3);
    for (int p = 0; p < count; ++p) {
      scales.data()[p] = static_cast<float>(std::exp(random.Normal()));
      coefficients.data()[p] = static_cast<float>(random.Normal());
    }
  }
  double At(int p) const { return double(scales.data()[p]) * coefficients.data()[p]; }
};

// Rounds with every kernel; they must agree, and stay within their memory.
std::vector<int16_t> Round(const Products& products, int count, float* unit) {
  std::vector<int16_t> first;
  for (const auto& [set, round] : RoundWeightsVariants()) {
    GuardedBuffer<int16_t> weights(static_cast<size_t>(count), int16_t{99});
    const float own =
        round(products.scales.data(), products.coefficients.data(), count, weights.data());
    EXPECT_TRUE(weights.intact()) << NameOf(set);
    const std::vector<int16_t> values(weights.data(), weights.data() + count);
    if (first.empty()) *unit = own;
    if (first.empty()) first = values;
    EXPECT_EQ(own, *unit) << NameOf(set);
    EXPECT_EQ(values, first) << NameOf(set);
  }
  return first;
}

TEST(RoundWeightsTest, WeightsTimesTheUnitAreTheProducts) {
  for (const int count : {1, 7, 8, 9, 130}) {
    const Products products(count);
    float unit = 0;
    const std::vector<int16_t> weights = Round(products, count, &unit);
    int largest = 0;
    for (int p = 0; p < count; ++p) {
      EXPECT_NEAR(weights[p] * double(unit), products.At(p), .5001 * unit) << count << " " << p;
      largest = std::max(largest, std::abs(weights[p]));
    }
    EXPECT_EQ(largest, 32767) << "all bits are used";
  }
}

TEST(RoundWeightsTest, SumsFitIn32BitsHoweverManyTermsThereAre) {
  constexpr int kCount = 3000;
  Products products(kCount);
  for (int p = 0; p < kCount; ++p) {
    products.scales.data()[p] = 1;
    products.coefficients.data()[p] = p % 2 == 0 ? 1.f : -1.f;
  }
  float unit = 0;
  int64_t sum = 0;
  for (const int16_t weight : Round(products, kCount, &unit)) sum += 127 * std::abs(weight);
  EXPECT_LE(sum, std::numeric_limits<int32_t>::max());
  EXPECT_GT(sum, std::numeric_limits<int32_t>::max() / 2);
}

TEST(RoundWeightsTest, NothingAndWhatIsNotFiniteHaveNoWeights) {
  for (const float value : {0.f, std::numeric_limits<float>::infinity(), std::nanf("")}) {
    Products products(11);
    if (value == 0) std::fill_n(products.coefficients.data(), 11, 0.f);
    products.coefficients.data()[4] = value;
    float unit = 1;
    EXPECT_EQ(Round(products, 11, &unit), std::vector<int16_t>(11, 0)) << value;
    EXPECT_EQ(unit, 0) << value;
  }
}

}  // namespace
}  // namespace pleat
