#include "pleat/simd/weighted_rows.h"

#include <gtest/gtest.h>

#include <array>

#include "support/random_data.h"

namespace pleat {
namespace {

template <typename Scalar>
void CompareKernels(Scalar tolerance) {
  using Matrix = Eigen::Matrix<Scalar, Eigen::Dynamic, Eigen::Dynamic>;
  constexpr int kNumVectors = 2 * kMaxWeightedTogether + 1;
  for (const int num_cols : {1, 40, 127, 128, 300}) {
    const Matrix rows = RandomMatrix(num_cols, 40, 1).template cast<Scalar>();  // a row a column
    const Matrix factors = RandomMatrix(40, kNumVectors, 2).template cast<Scalar>();
    const Matrix start = RandomMatrix(num_cols, kNumVectors, 3).template cast<Scalar>();
    const Matrix reference = start + rows * factors;
    Matrix expected = start;
    std::array<const Scalar*, kNumVectors> factor_pointers;
    std::array<Scalar*, kNumVectors> sum_pointers;
    for (int q = 0; q < kNumVectors; ++q) {
      factor_pointers[q] = factors.col(q).data();
      sum_pointers[q] = expected.col(q).data();
    }
    AddWeightedRows(factor_pointers, rows.data(), 40, num_cols, sum_pointers);
    EXPECT_LT((expected - reference).cwiseAbs().maxCoeff(), tolerance);
    for (const auto& [set, kernel] : WeightedRowsVariants<Scalar>()) {
      for (int count = 1; count <= kMaxWeightedTogether; ++count) {
        Matrix sums = start.leftCols(count);
        for (int q = 0; q < count; ++q) sum_pointers[q] = sums.col(q).data();
        kernel.add[count - 1](factor_pointers.data(), rows.data(), 40, num_cols,
                              sum_pointers.data());
        EXPECT_EQ(sums, expected.leftCols(count)) << NameOf(set);
      }
    }
  }
}

TEST(WeightedRowsTest, EveryKernelGivesTheSameBits) {
  CompareKernels<float>(1e-4f);
  CompareKernels<double>(1e-12);
}

}  // namespace
}  // namespace pleat
