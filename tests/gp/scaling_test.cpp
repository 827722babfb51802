#include "pleat/gp/scaling.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "support/random_data.h"

namespace pleat {
namespace {

using ::testing::ElementsAre;

TEST(ScalingTest, RootsOfWhatIsNotPositiveAreOne) {
  EXPECT_EQ(PositiveRoot(9), 3);
  EXPECT_EQ(PositiveRoot(0), 1);
  EXPECT_EQ(PositiveRoot(-4), 1);
  EXPECT_EQ(PositiveRoot(std::nan("")), 1);
}

TEST(ScalingTest, ColumnsGetUnitVarianceAndConstantOnesStay) {
  Eigen::MatrixXd columns = RandomMatrix(50, 4, 1);
  columns.col(1) *= 1000;
  columns.rowwise() -= columns.colwise().mean().eval();
  columns.col(2).setZero();
  columns.col(3) *= 1e-14;  // what rounding leaves of a constant column
  const Eigen::VectorXd rounding = columns.col(3);
  ScaleColumns(&columns);
  EXPECT_NEAR(columns.col(0).squaredNorm() / 49, 1, 1e-12);
  EXPECT_NEAR(columns.col(1).squaredNorm() / 49, 1, 1e-12);
  EXPECT_TRUE(columns.col(2).isZero());
  EXPECT_EQ(columns.col(3), rounding);
}

TEST(ScalingTest, TheMedianIsOfTheDistancesBelowTheDiagonal) {
  Eigen::MatrixXd distances = Eigen::MatrixXd::Constant(3, 3, 1e9);  // above: not read
  distances.diagonal().setZero();
  distances(1, 0) = 4;
  distances(2, 0) = 9;
  distances(2, 1) = 1;
  EXPECT_EQ(MedianSquaredDistance(distances), 4);
  distances(2, 0) = 0;  // equal rows do not count
  EXPECT_EQ(MedianSquaredDistance(distances), 4);
  EXPECT_EQ(MedianSquaredDistance(Eigen::MatrixXd::Zero(5, 5)), 1);
  EXPECT_EQ(MedianSquaredDistance(Eigen::MatrixXd::Zero(1, 1)), 1);
}

TEST(ScalingTest, SpreadRowsAreEvenAscendingAndAtLeastOne) {
  EXPECT_THAT(SpreadRows(10, 5), ElementsAre(0, 2, 4, 6, 8));
  EXPECT_THAT(SpreadRows(3, 10), ElementsAre(0, 1, 2));
  EXPECT_THAT(SpreadRows(10, 1), ElementsAre(0));
  EXPECT_THAT(SpreadRows(10, 0), ElementsAre(0));
  for (const int num_rows : {7, 100, 1001}) {
    for (const int count : {2, 3, 6}) {
      const std::vector<Eigen::Index> rows = SpreadRows(num_rows, count);
      ASSERT_EQ(rows.size(), static_cast<size_t>(count));
      for (size_t i = 1; i < rows.size(); ++i) {
        EXPECT_NEAR(static_cast<double>(rows[i] - rows[i - 1]), double(num_rows) / count, 1);
      }
      EXPECT_LT(rows.back(), num_rows);
    }
  }
}

}  // namespace
}  // namespace pleat
