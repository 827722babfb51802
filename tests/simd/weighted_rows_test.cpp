#include "pleat/simd/weighted_rows.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "simd/guarded_buffer.h"
#include "support/random_data.h"

namespace pleat {
namespace {

// Rows, factors and sums, none of them aligned, and a plain sum in the promised order.
template <typename Scalar>
struct Products {
  using Buffers = std::vector<GuardedBuffer<Scalar>>;

  int num_rows, num_cols;
  GuardedBuffer<Scalar> rows;
  Buffers factors, start;

  Products(int num_rows, int num_cols, int num_vectors)
      : num_rows(num_rows), num_cols(num_cols), rows(RandomValues(num_rows * num_cols, 1)) {
    for (int q = 0; q < num_vectors; ++q) {
      factors.emplace_back(RandomValues(num_rows, 2 + q));
      start.emplace_back(RandomValues(num_cols, 20 + q));
    }
  }
  static std::vector<Scalar> RandomValues(int count, uint64_t seed) {
    const auto values = RandomMatrix(count, 1, seed).cast<Scalar>().eval();
    return {values.data(), values.data() + count};
  }

  std::vector<Scalar> Expected(size_t q) const {
    std::vector<Scalar> sums = start[q].content();
    for (int n = 0; n < num_rows; ++n) {
      for (int c = 0; c < num_cols; ++c) {
        sums[c] += factors[q].data()[n] * rows.data()[n * num_cols + c];
      }
    }
    return sums;
  }
  // add(factor pointers, sum pointers) for the first `count` vectors.
  template <typename Add>
  Buffers Sums(size_t count, Add&& add) const {
    Buffers sums(start.begin(), start.begin() + static_cast<ptrdiff_t>(count));
    std::vector<const Scalar*> factor_pointers;
    std::vector<Scalar*> sum_pointers;
    for (size_t q = 0; q < count; ++q) {
      factor_pointers.push_back(factors[q].data());
      sum_pointers.push_back(sums[q].data());
    }
    add(factor_pointers, sum_pointers);
    return sums;
  }
  void Check(const Buffers& sums, const char* who) const {
    for (size_t q = 0; q < sums.size(); ++q) {
      EXPECT_EQ(sums[q].content(), Expected(q)) << who << " vector " << q << " of " << sums.size();
      EXPECT_TRUE(sums[q].intact()) << who;
    }
  }
  void CheckEveryKernel() const {
    for (const auto& [set, kernel] : WeightedRowsVariants<Scalar>()) {
      for (size_t count = 1; count <= kMaxWeightedTogether; ++count) {
        Check(Sums(count,
                   [&, &kernel = kernel](const auto& factor_pointers, const auto& sum_pointers) {
                     kernel.add[count - 1](factor_pointers.data(), rows.data(), num_rows, num_cols,
                                           sum_pointers.data());
                   }),
              NameOf(set));
      }
    }
  }
};

template <typename Scalar>
class WeightedRowsTest : public ::testing::Test {};
using Scalars = ::testing::Types<float, double>;
TYPED_TEST_SUITE(WeightedRowsTest, Scalars);

// Widths around one register and around the block of registers of one pass, in both types.
TYPED_TEST(WeightedRowsTest, EveryKernelGivesTheBitsOfAPlainSum) {
  for (const int num_cols : {0, 1, 7, 8, 9, 15, 16, 17, 31, 33, 63, 64, 65, 127, 128, 129, 300}) {
    for (const int num_rows : {0, 1, 2, 40}) {
      Products<TypeParam>(num_rows, num_cols, kMaxWeightedTogether).CheckEveryKernel();
    }
  }
}

TYPED_TEST(WeightedRowsTest, AnyNumberOfVectorsIsTheSameAsOneByOne) {
  for (size_t count = 0; count <= 2 * kMaxWeightedTogether + 1; ++count) {
    const Products<TypeParam> products(11, 70, static_cast<int>(count));
    products.Check(products.Sums(count,
                                 [&](const auto& factor_pointers, const auto& sum_pointers) {
                                   AddWeightedRows(factor_pointers, products.rows.data(), 11, 70,
                                                   sum_pointers);
                                 }),
                   "AddWeightedRows");
  }
}

TYPED_TEST(WeightedRowsTest, WhatIsNotFiniteStaysInItsColumn) {
  for (const TypeParam bad :
       {std::numeric_limits<TypeParam>::infinity(), std::numeric_limits<TypeParam>::quiet_NaN()}) {
    for (const int column : {0, 8, 69}) {
      Products<TypeParam> products(3, 70, kMaxWeightedTogether);
      products.rows.data()[70 + column] = bad;
      for (const auto& [set, kernel] : WeightedRowsVariants<TypeParam>()) {
        const auto sums = products.Sums(
            kMaxWeightedTogether,
            [&, &kernel = kernel](const auto& factor_pointers, const auto& sum_pointers) {
              kernel.add[kMaxWeightedTogether - 1](factor_pointers.data(), products.rows.data(), 3,
                                                   70, sum_pointers.data());
            });
        for (const auto& sum : sums) {
          for (int c = 0; c < 70; ++c) {
            EXPECT_EQ(std::isfinite(sum.data()[c]), c != column) << NameOf(set) << " " << c;
          }
        }
      }
    }
  }
}

TYPED_TEST(WeightedRowsTest, SubnormalNumbersAreNotFlushed) {
  Products<TypeParam> products(5, 33, kMaxWeightedTogether);
  std::fill_n(products.rows.data(), 5 * 33, std::numeric_limits<TypeParam>::denorm_min());
  for (auto& factors : products.factors) std::fill_n(factors.data(), 5, TypeParam(3));
  for (auto& start : products.start) std::fill_n(start.data(), 33, TypeParam(0));
  ASSERT_EQ(products.Expected(0)[0], 15 * std::numeric_limits<TypeParam>::denorm_min());
  products.CheckEveryKernel();
}

}  // namespace
}  // namespace pleat
