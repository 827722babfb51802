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

TEST(NearestTest, TheDistanceOfEveryRowIsTheSmallest) {
  const Eigen::MatrixXd rows = RandomMatrix(40, 5, 1), queries = RandomMatrix(30, 5, 2);
  const std::vector<int> nearest = NearestRows(rows, queries);
  ASSERT_EQ(nearest.size(), 30u);
  for (int q = 0; q < 30; ++q) {
    for (int n = 0; n < 40; ++n) {
      EXPECT_LE((rows.row(nearest[q]) - queries.row(q)).norm(),
                (rows.row(n) - queries.row(q)).norm());
    }
  }
  EXPECT_TRUE(NearestRows(rows, queries.topRows(0)).empty());
}

}  // namespace
}  // namespace pleat
