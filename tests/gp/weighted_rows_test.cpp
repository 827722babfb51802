#include "weighted_rows.h"

#include <gtest/gtest.h>

#include <array>

#include "random_data.h"

namespace pleat {
namespace {

TEST(WeightedRowsTest, EveryKernelGivesTheSameBits) {
  constexpr int kNumVectors = 2 * kMaxWeightedTogether + 1;
  for (const int num_cols : {1, 127, 128, 300}) {
    const Eigen::MatrixXf rows = RandomMatrix(num_cols, 40, 1).cast<float>();  // a row a column
    const Eigen::MatrixXf factors = RandomMatrix(40, kNumVectors, 2).cast<float>();
    const Eigen::MatrixXf start = RandomMatrix(num_cols, kNumVectors, 3).cast<float>();
    const Eigen::MatrixXf reference = start + rows * factors;
    Eigen::MatrixXf expected = start;
    std::array<const float*, kNumVectors> factor_pointers;
    std::array<float*, kNumVectors> sum_pointers;
    for (int q = 0; q < kNumVectors; ++q) {
      factor_pointers[q] = factors.col(q).data();
      sum_pointers[q] = expected.col(q).data();
    }
    AddWeightedRows(factor_pointers, rows.data(), 40, num_cols, sum_pointers);
    EXPECT_LT((expected - reference).cwiseAbs().maxCoeff(), 1e-4f);
    for (const WeightedRowsKernel* kernel : UsableWeightedRows()) {
      for (int count = 1; count <= kMaxWeightedTogether; ++count) {
        Eigen::MatrixXf sums = start.leftCols(count);
        for (int q = 0; q < count; ++q) sum_pointers[q] = sums.col(q).data();
        kernel->add[count - 1](factor_pointers.data(), rows.data(), 40, num_cols,
                               sum_pointers.data());
        EXPECT_EQ(sums, expected.leftCols(count));
      }
    }
  }
}

}  // namespace
}  // namespace pleat
