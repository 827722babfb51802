#include "weighted_rows.h"

#include <gtest/gtest.h>

#include "random_data.h"

namespace pleat {
namespace {

TEST(WeightedRowsTest, EveryKernelGivesTheSameBits) {
  for (const int num_cols : {1, 127, 128, 300}) {
    const Eigen::MatrixXf rows = RandomMatrix(num_cols, 40, 1).cast<float>();  // a row a column
    const Eigen::VectorXf factors = RandomMatrix(40, 1, 2).cast<float>();
    const Eigen::VectorXf start = RandomMatrix(num_cols, 1, 3).cast<float>();
    const Eigen::VectorXf reference = start + rows * factors;
    Eigen::VectorXf expected;
    for (const AddWeightedRowsFunction add : UsableAddWeightedRows()) {
      Eigen::VectorXf sums = start;
      add(factors.data(), rows.data(), 40, num_cols, sums.data());
      if (expected.size() == 0) expected = sums;
      EXPECT_EQ(sums, expected);
      EXPECT_LT((sums - reference).cwiseAbs().maxCoeff(), 1e-4f);
    }
  }
}

}  // namespace
}  // namespace pleat
