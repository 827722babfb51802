#include "pleat/math/principal_axes.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include "pleat/base/random.h"

namespace pleat {
namespace {

// An ellipsoid of points, turned and moved: its axes are the turned ones, least spread first.
TEST(PrincipalAxesTest, AreThoseOfATurnedCloudInTheOrderOfTheirSpread) {
  Random random(3);
  const Eigen::Matrix3d turn =
      Eigen::AngleAxisd(1.1, Eigen::Vector3d(1, 2, -2).normalized()).toRotationMatrix();
  const Eigen::Vector3d center(4, -5, 6);
  Eigen::Matrix3Xd points(3, 2000);
  for (Eigen::Index i = 0; i < 1000; ++i) {
    // In pairs of opposite signs, so that the mean is the center.
    const Eigen::Vector3d point(random.Normal(), 5 * random.Normal(), .2 * random.Normal());
    points.col(2 * i) = center + turn * point;
    points.col(2 * i + 1) = center - turn * point;
  }
  const Eigen::Matrix3d axes = PrincipalAxes(points, center);
  EXPECT_TRUE((axes.transpose() * axes).isIdentity(1e-12));
  EXPECT_GT(std::abs(axes.col(0).dot(turn.col(2))), .999);
  EXPECT_GT(std::abs(axes.col(1).dot(turn.col(0))), .99);
  EXPECT_GT(std::abs(axes.col(2).dot(turn.col(1))), .99);
}

TEST(PrincipalAxesTest, PointsWithoutSpreadHaveAxesAllTheSame) {
  const Eigen::Matrix3Xd point = Eigen::Vector3d(1, 2, 3);
  const Eigen::Matrix3d axes = PrincipalAxes(point, {1, 2, 3});
  EXPECT_TRUE((axes.transpose() * axes).isIdentity(1e-12));
}

}  // namespace
}  // namespace pleat
