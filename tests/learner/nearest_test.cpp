#include "pleat/learner/nearest.h"

#include <gtest/gtest.h>

#include "support/random_data.h"

namespace pleat {
namespace {

TEST(NearestTest, FindsItselfAndTheFirstOfEquals) {
  Eigen::MatrixXd rows = RandomMatrix(20, 3, 1);
  rows.row(12) = rows.row(4);
  const std::vector<int> nearest = NearestRows(rows, rows);
  for (int i = 0; i < 20; ++i) EXPECT_EQ(nearest[i], i == 12 ? 4 : i);
}

TEST(NearestTest, TakesTheCloserOfTwo) {
  const Eigen::MatrixXd rows = (Eigen::MatrixXd(2, 1) << 0, 1).finished();
  const Eigen::MatrixXd queries = (Eigen::MatrixXd(3, 1) << -5, .4, .6).finished();
  EXPECT_EQ(NearestRows(rows, queries), (std::vector<int>{0, 0, 1}));
}

}  // namespace
}  // namespace pleat
