#include "pleat/geometry/point_index.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "pleat/base/random.h"

namespace pleat {
namespace {

TEST(PointIndexTest, FindsWhatASearchOfAllPointsFinds) {
  Random random(1);
  Eigen::Matrix3Xd points(3, 300);
  for (double& x : points.reshaped()) x = random.Normal();
  const PointIndex index(points);
  for (int i = 0; i < 20; ++i) {
    const Eigen::Vector3d query(random.Normal(), random.Normal(), random.Normal());
    const Eigen::VectorXd squared = (points.colwise() - query).colwise().squaredNorm().transpose();
    std::vector<int> order(300);
    for (int p = 0; p < 300; ++p) order[p] = p;
    std::sort(order.begin(), order.end(), [&](int a, int b) { return squared[a] < squared[b]; });
    double nearest = 0;
    EXPECT_EQ(index.Nearest(query, &nearest), order[0]);
    EXPECT_NEAR(nearest, squared[order[0]], 1e-12);
    const auto few = index.NearestFew(query, 5);
    ASSERT_EQ(few.size(), 5u);
    for (int k = 0; k < 5; ++k) EXPECT_EQ(few[k].first, order[k]);
    EXPECT_EQ(static_cast<int>(index.Within(query, 1).size()), (squared.array() < 1).count());
  }
}

TEST(PointIndexTest, MayBeEmpty) {
  const PointIndex index(Eigen::Matrix3Xd(3, 0));
  double squared = 0;
  EXPECT_EQ(index.Nearest(Eigen::Vector3d::Zero(), &squared), -1);
  EXPECT_EQ(squared, std::numeric_limits<double>::infinity());
  EXPECT_TRUE(index.NearestFew(Eigen::Vector3d::Zero(), 3).empty());
}

}  // namespace
}  // namespace pleat
