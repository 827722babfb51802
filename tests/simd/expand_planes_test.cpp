#include "pleat/simd/expand_planes.h"

#include <gtest/gtest.h>

#include <array>
#include <limits>
#include <vector>

#include "pleat/base/random.h"
#include "simd/guarded_buffer.h"

namespace pleat {
namespace {

constexpr float kUntouched = -99;

// Blocks of values and the weights of four queries, none of them aligned.
struct Planes {
  int num_pairs;
  GuardedBuffer<int8_t> values;
  GuardedBuffer<float> mean;
  std::vector<GuardedBuffer<int16_t>> weights;
  std::array<float, kMaxTogether> units = {1e-3f, 2.f, -3e-5f, 0.f};

  explicit Planes(int pairs)
      : num_pairs(pairs),
        values(static_cast<size_t>(pairs * 2 * kPlaneRows)),
        mean(kPlaneRows),
        weights(kMaxTogether, GuardedBuffer<int16_t>(static_cast<size_t>(2 * pairs))) {}

  float Expected(int q, int row) const {
    int64_t sum = 0;
    for (int p = 0; p < 2 * num_pairs; ++p) {
      sum += int64_t{weights[q].data()[p]} * values.data()[(p / 2 * kPlaneRows + row) * 2 + p % 2];
    }
    EXPECT_LE(std::abs(sum), std::numeric_limits<int32_t>::max()) << "not what a kernel promises";
    const float scaled = units[q] * static_cast<float>(sum);
    return mean.data()[row] + scaled;
  }
  // The details of `count` queries, from `first` on.
  std::vector<GuardedBuffer<float>> Expand(const PlaneKernel& kernel, int first, int count) const {
    std::vector<GuardedBuffer<float>> details(kMaxTogether,
                                              GuardedBuffer<float>(kPlaneRows, kUntouched));
    std::array<float*, kMaxTogether> targets{};
    std::array<const int16_t*, kMaxTogether> weight_pointers{};
    for (int q = 0; q < count; ++q) {
      targets[q] = details[q].data();
      weight_pointers[q] = weights[first + q].data();
    }
    kernel.expand[count - 1](values.data(), mean.data(), num_pairs, weight_pointers.data(),
                             units.data() + first, targets.data());
    return details;
  }
  void CheckEveryKernel() const {
    for (const auto& [set, kernel] : PlaneVariants()) {
      for (int count = 1; count <= kMaxTogether; ++count) {
        const std::vector<GuardedBuffer<float>> details = Expand(kernel, 0, count);
        for (int q = 0; q < kMaxTogether; ++q) {
          EXPECT_TRUE(details[q].intact()) << NameOf(set);
          for (int row = 0; row < kPlaneRows; ++row) {
            EXPECT_EQ(details[q].data()[row], q < count ? Expected(q, row) : kUntouched)
                << NameOf(set) << " query " << q << " of " << count << ", row " << row;
          }
        }
      }
    }
  }
};

Planes RandomPlanes(int num_pairs) {
  Planes planes(num_pairs);
  Random random(7);
  for (int i = 0; i < num_pairs * 2 * kPlaneRows; ++i) {
    planes.values.data()[i] = static_cast<int8_t>(random.UniformInt(256) - 128);
  }
  for (int row = 0; row < kPlaneRows; ++row) {
    planes.mean.data()[row] = static_cast<float>(random.Normal());
  }
  for (GuardedBuffer<int16_t>& weights : planes.weights) {
    for (int p = 0; p < 2 * num_pairs; ++p) {
      weights.data()[p] = static_cast<int16_t>(random.UniformInt(65536) - 32768);
    }
  }
  return planes;
}

class ExpandPlanesTest : public ::testing::TestWithParam<int> {};

TEST_P(ExpandPlanesTest, EveryKernelGivesTheBitsOfAPlainSum) {
  RandomPlanes(GetParam()).CheckEveryKernel();
}

TEST_P(ExpandPlanesTest, AQueryIsTheSameAloneAndInCompany) {
  const Planes planes = RandomPlanes(GetParam());
  for (const auto& [set, kernel] : PlaneVariants()) {
    const auto together = planes.Expand(kernel, 0, kMaxTogether);
    for (int q = 0; q < kMaxTogether; ++q) {
      EXPECT_EQ(planes.Expand(kernel, q, 1)[0].content(), together[q].content()) << NameOf(set);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Pairs, ExpandPlanesTest, ::testing::Values(0, 1, 2, 3, 37, 64));

// The most that a sum of 32 bits holds: 255 pairs of the largest products, of both signs.
TEST(ExpandPlanesExtremesTest, TheLargestSumsDoNotOverflow) {
  constexpr int kMostPairs = 255;
  for (const int8_t value : {std::numeric_limits<int8_t>::min(), int8_t{127}}) {
    Planes planes(kMostPairs);
    std::fill_n(planes.values.data(), kMostPairs * 2 * kPlaneRows, value);
    for (int q = 0; q < kMaxTogether; ++q) {
      const int16_t weight = q % 2 == 0 ? std::numeric_limits<int16_t>::min() : int16_t{32767};
      std::fill_n(planes.weights[q].data(), 2 * kMostPairs, weight);
    }
    planes.CheckEveryKernel();
  }
}

// Half of a pair is not mistaken for the other.
TEST(ExpandPlanesExtremesTest, EachValueMeetsItsOwnWeight) {
  for (int p = 0; p < 4; ++p) {
    for (const int row : {0, 15, 16, 31, 32, 47}) {
      Planes planes(2);
      planes.values.data()[(p / 2 * kPlaneRows + row) * 2 + p % 2] = -3;
      for (auto& weights : planes.weights) weights.data()[p] = 1000;
      planes.units.fill(1);
      for (const auto& [set, kernel] : PlaneVariants()) {
        std::vector<float> expected(kPlaneRows, 0.f);
        expected[row] = -3000;
        for (const auto& details : planes.Expand(kernel, 0, kMaxTogether)) {
          EXPECT_EQ(details.content(), expected) << NameOf(set) << " " << p << " " << row;
        }
      }
    }
  }
}

}  // namespace
}  // namespace pleat
