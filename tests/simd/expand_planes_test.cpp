#include "pleat/simd/expand_planes.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "support/random_data.h"

namespace pleat {
namespace {

TEST(ExpandPlanesTest, EveryKernelGivesTheSameBits) {
  constexpr int kNumPairs = 37;
  const auto random = [](int count, double range, uint64_t seed) {
    return (range * RandomMatrix(count, 1, seed)).array().round().eval();
  };
  const Eigen::Array<int8_t, Eigen::Dynamic, 1> values =
      random(kNumPairs * 2 * kPlaneRows, 40, 1).min(127).max(-127).cast<int8_t>();
  const Eigen::VectorXf mean = RandomMatrix(kPlaneRows, 1, 2).cast<float>();
  std::array<Eigen::Array<int16_t, Eigen::Dynamic, 1>, kMaxTogether> weights;
  std::array<const int16_t*, kMaxTogether> weight_pointers;
  for (int q = 0; q < kMaxTogether; ++q) {
    weights[q] = random(2 * kNumPairs, 9000, 3 + q).min(32767).max(-32767).cast<int16_t>();
    weight_pointers[q] = weights[q].data();
  }
  const std::array<float, kMaxTogether> units = {1e-3f, 2.f, 3e-5f, 0.f};
  for (int count = 1; count <= kMaxTogether; ++count) {
    Eigen::MatrixXf expected;
    for (const auto& [set, kernel] : PlaneVariants()) {
      Eigen::MatrixXf details(kPlaneRows, count);
      std::array<float*, kMaxTogether> targets{};
      for (int q = 0; q < count; ++q) targets[q] = details.col(q).data();
      kernel.expand[count - 1](values.data(), mean.data(), kNumPairs, weight_pointers.data(),
                               units.data(), targets.data());
      if (expected.size() == 0) expected = details;
      EXPECT_EQ(details, expected) << NameOf(set);
    }
    double sum = 0;
    for (int p = 0; p < 2 * kNumPairs; ++p) {
      sum += double(weights[0][p]) * values[(p / 2 * kPlaneRows + 5) * 2 + p % 2];
    }
    EXPECT_NEAR(expected(5, 0), mean[5] + 1e-3 * sum, 1e-6 * std::abs(1e-3 * sum) + 1e-6);
  }
}

}  // namespace
}  // namespace pleat
