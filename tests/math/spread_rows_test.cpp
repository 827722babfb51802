#include "pleat/math/spread_rows.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <vector>

namespace pleat {
namespace {

using testing::ElementsAre;

TEST(SpreadRowsTest, RowsAreEvenAscendingAndAtLeastOne) {
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
