// The sweeps over lower triangles of every instruction set against plain loops.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "pleat/simd/dense.h"
#include "simd/guarded_buffer.h"
#include "support/random_data.h"

namespace pleat {
namespace {

using Buffer = GuardedBuffer<double>;

constexpr double kG = .7, kA = 1.5, kBias = .2, kLinear = -.4, kHalfWeight = -.75;

std::vector<double> RandomValues(int count, uint64_t seed) {
  const Eigen::MatrixXd values = RandomMatrix(count, 1, seed);
  return {values.data(), values.data() + count};
}

// For every number of rows: around the eight lanes of a sweep, and columns shorter than them.
class SweepsTest : public ::testing::TestWithParam<int> {
 protected:
  int n() const { return GetParam(); }
  template <typename Visit>
  void ForEachLower(Visit&& visit) const {
    for (int j = 0; j < n(); ++j) {
      for (int i = j; i < n(); ++i) visit(i, j, static_cast<size_t>(i + j * n()));
    }
  }
  double Rbf(size_t entry) const { return kA * std::exp(-.5 * kG * squared_[entry]); }

  const size_t size_ = static_cast<size_t>(n() * n());
  const std::vector<double> squared_ = [this] {
    std::vector<double> values = RandomValues(n() * n(), 1);
    for (double& value : values) value = value * value * 4;
    return values;
  }();
  const std::vector<double> inner_ = RandomValues(n() * n(), 2);
};

TEST_P(SweepsTest, DistancesHaveTheBitsOfAPlainSum) {
  for (const int q : {0, 1, 3, 13}) {
    const Buffer x(RandomValues(n() * q, 3));
    for (const auto& [set, ops] : DenseVariants()) {
      Buffer r(size_);
      ops->squared_distances(x.data(), n(), q, r.data());
      EXPECT_TRUE(r.intact()) << NameOf(set);
      ForEachLower([&](int i, int j, size_t entry) {
        double sum = 0;
        for (int d = 0; d < q; ++d) {
          const double difference = x.data()[i + d * n()] - x.data()[j + d * n()];
          sum += difference * difference;
        }
        EXPECT_EQ(r.data()[entry], sum) << NameOf(set) << " " << i << " " << j;
      });
    }
  }
}

TEST_P(SweepsTest, KernelsAgreeWithTheirFormula) {
  const Buffer r(squared_), t(inner_);
  for (const double* linear : {static_cast<const double*>(nullptr), t.data()}) {
    std::vector<double> fused;
    for (const auto& [set, ops] : DenseVariants()) {
      Buffer k(size_);
      ops->kernel(r.data(), linear, n(), kG, kA, kBias, kLinear, k.data());
      EXPECT_TRUE(k.intact()) << NameOf(set);
      ForEachLower([&](int i, int j, size_t entry) {
        const double expected = Rbf(entry) + kBias + (linear ? kLinear * inner_[entry] : 0);
        EXPECT_NEAR(k.data()[entry], expected, 1e-14) << NameOf(set) << " " << i << " " << j;
      });
      if (set == InstructionSet::kBaseline) continue;
      if (fused.empty()) fused = k.content();
      ForEachLower([&](int, int, size_t entry) { EXPECT_EQ(k.data()[entry], fused[entry]); });
    }
  }
}

TEST_P(SweepsTest, GramSumsCountEveryEntryOnce) {
  const std::vector<double> given = RandomValues(n() * n(), 4);
  const Buffer r(squared_), t(inner_);
  for (const double* linear : {static_cast<const double*>(nullptr), t.data()}) {
    GramSums expected;
    ForEachLower([&](int i, int j, size_t entry) {
      const double a = kHalfWeight * given[entry], twice = i == j ? a : 2 * a;
      if (i == j) expected.trace += a;
      expected.total += twice;
      // On the diagonal points are their own neighbors, whatever R holds there.
      expected.amplitude += twice * (i == j ? kA : Rbf(entry));
      if (i != j) expected.distance += twice * Rbf(entry) * squared_[entry];
      if (linear) expected.linear += twice * inner_[entry];
    });
    for (const auto& [set, ops] : DenseVariants()) {
      Buffer gradient(given), p(size_), in_place(given);
      const GramSums sums =
          ops->gram_gradient(gradient.data(), r.data(), linear, n(), kG, kA, kHalfWeight, p.data());
      const double scale = 1e-13 * (1 + n() * n());
      EXPECT_NEAR(sums.trace, expected.trace, scale) << NameOf(set);
      EXPECT_NEAR(sums.total, expected.total, scale) << NameOf(set);
      EXPECT_NEAR(sums.amplitude, expected.amplitude, scale) << NameOf(set);
      EXPECT_NEAR(sums.distance, expected.distance, scale) << NameOf(set);
      EXPECT_NEAR(sums.linear, expected.linear, scale) << NameOf(set);
      ForEachLower([&](int i, int j, size_t entry) {
        EXPECT_EQ(gradient.data()[entry], kHalfWeight * given[entry]) << i << " " << j;
        EXPECT_NEAR(p.data()[entry], kHalfWeight * given[entry] * Rbf(entry), 1e-14);
      });
      const GramSums same = ops->gram_gradient(in_place.data(), r.data(), linear, n(), kG, kA,
                                               kHalfWeight, in_place.data());
      ForEachLower([&](int i, int j, size_t entry) {
        EXPECT_EQ(in_place.data()[entry], p.data()[entry]) << NameOf(set) << " " << i << " " << j;
      });
      EXPECT_EQ(same.amplitude, sums.amplitude) << NameOf(set);
      EXPECT_EQ(same.linear, sums.linear) << NameOf(set);
      EXPECT_TRUE(gradient.intact() && p.intact() && in_place.intact()) << NameOf(set);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Rows, SweepsTest,
                         ::testing::Values(0, 1, 2, 3, 7, 8, 9, 15, 16, 17, 31, 40));

TEST(SquaredDistancesTest, PointsFarApartAreInfinitelyFarAndThenNotAlike) {
  const std::vector<double> x = {0, 1e200, -1e200, 3};
  for (const auto& [set, ops] : DenseVariants()) {
    Buffer r(16), k(16);
    ops->squared_distances(x.data(), 4, 1, r.data());
    ops->kernel(r.data(), nullptr, 4, kG, kA, 0, 0, k.data());
    EXPECT_EQ(r.data()[1], std::numeric_limits<double>::infinity()) << NameOf(set);
    EXPECT_LT(k.data()[1], 1e-300) << NameOf(set);
    EXPECT_EQ(r.data()[3], 9) << NameOf(set);
    EXPECT_EQ(k.data()[0], kA) << NameOf(set);
  }
}

class ExponentialTest : public ::testing::TestWithParam<int> {};

TEST_P(ExponentialTest, ChangesTheGivenValuesOnly) {
  std::vector<double> values = RandomValues(GetParam(), 5);
  for (double& value : values) value = -20 * std::abs(value);
  std::vector<double> fused;
  for (const auto& [set, ops] : DenseVariants()) {
    Buffer result(values);
    ops->exp_in_place(result.data(), GetParam());
    EXPECT_TRUE(result.intact()) << NameOf(set);
    for (size_t i = 0; i < values.size(); ++i) {
      const double truth = std::exp(values[i]);
      EXPECT_NEAR(result.data()[i], truth, 1e-15 * truth) << NameOf(set) << " " << i;
    }
    if (set == InstructionSet::kBaseline) continue;
    if (fused.empty()) fused = result.content();
    EXPECT_EQ(result.content(), fused) << NameOf(set);
  }
}

INSTANTIATE_TEST_SUITE_P(Counts, ExponentialTest,
                         ::testing::Values(0, 1, 2, 3, 4, 5, 7, 8, 9, 15, 16, 17, 1000));

// Where the argument reduction turns to the next power of two the remainder is largest.
TEST(ExponentialEdgesTest, IsAccurateWhereTheReductionTurns) {
  std::vector<double> values;
  for (int half = 0; half <= 2042; ++half) {
    const double edge = -half * M_LN2 / 2;
    for (const double x : {std::nextafter(edge, -1e9), edge, std::nextafter(edge, 0.)}) {
      if (x > -708) values.push_back(x);
    }
  }
  for (const auto& [set, ops] : DenseVariants()) {
    std::vector<double> result = values;
    ops->exp_in_place(result.data(), std::ssize(result));
    for (size_t i = 0; i < values.size(); ++i) {
      EXPECT_NEAR(result[i] / std::exp(values[i]), 1, 1e-15) << NameOf(set) << " " << values[i];
    }
  }
}

TEST(ExponentialEdgesTest, OfNothingIsExactlyOne) {
  const double least = std::numeric_limits<double>::denorm_min();
  for (const auto& [set, ops] : DenseVariants()) {
    std::vector<double> values = {0., -0., -least, -1e-300, -1e-17};
    ops->exp_in_place(values.data(), std::ssize(values));
    EXPECT_EQ(values, std::vector<double>(5, 1.)) << NameOf(set);
  }
}

}  // namespace
}  // namespace pleat
