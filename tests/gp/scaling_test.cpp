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

}  // namespace
}  // namespace pleat
