#include "pleat/render/camera.h"

#include <gtest/gtest.h>

#include <cmath>

#include "support/random_data.h"

namespace pleat {
namespace {

ViewOptions View(Projection projection, double azimuth_degrees = 0, double elevation_degrees = 0) {
  return {.width = 300,
          .height = 200,
          .projection = projection,
          .azimuth_degrees = azimuth_degrees,
          .elevation_degrees = elevation_degrees};
}

TEST(CameraTest, EverythingIsInsideTheMarginFromEveryDirection) {
  const Eigen::Matrix3Xd points = RandomMatrix(3, 40, 1);
  for (const Projection projection : {Projection::kOrthographic, Projection::kPerspective}) {
    for (double azimuth = -180; azimuth < 180; azimuth += 37) {
      for (const double elevation : {-90., -30., 0., 8., 90.}) {
        const Camera camera = Camera::Fit(View(projection, azimuth, elevation), points);
        double fullest = 0;
        for (int i = 0; i < points.cols(); ++i) {
          const Eigen::Vector3d p = camera.Project(points.col(i));
          EXPECT_GE(p.x(), .05 * 300 - 1e-6);
          EXPECT_LE(p.x(), .95 * 300 + 1e-6);
          EXPECT_GE(p.y(), .05 * 200 - 1e-6);
          EXPECT_LE(p.y(), .95 * 200 + 1e-6);
          fullest = std::max({fullest, std::abs(p.x() - 150) / 150, std::abs(p.y() - 100) / 100});
        }
        EXPECT_GT(fullest, .5);  // and the picture is used
      }
    }
  }
}

TEST(CameraTest, AxesOfThePictureAreRightAndUp) {
  Eigen::Matrix3Xd points(3, 2);
  points << -1, 1, -1, 1, -1, 1;
  for (const Projection projection : {Projection::kOrthographic, Projection::kPerspective}) {
    // From the front +x is to the right; from the side of +x the one at -z is.
    const Camera front = Camera::Fit(View(projection), points);
    EXPECT_GT(front.Project({1, 0, 0}).x(), front.Project({-1, 0, 0}).x());
    EXPECT_LT(front.Project({0, 1, 0}).y(), front.Project({0, -1, 0}).y());
    EXPECT_LT(front.Project({0, 0, 1}).z(), front.Project({0, 0, -1}).z());  // nearer
    const Camera side = Camera::Fit(View(projection, 90), points);
    EXPECT_GT(side.Project({0, 0, -1}).x(), side.Project({0, 0, 1}).x());
    EXPECT_LT(side.Project({1, 0, 0}).z(), side.Project({-1, 0, 0}).z());
  }
}

TEST(CameraTest, OrthographicDoesNotShrinkWithDistanceAndPerspectiveDoes) {
  Eigen::Matrix3Xd points(3, 2);
  points << -1, 1, -1, 1, -1, 1;
  const auto width_at = [](const Camera& camera, double z) {
    return camera.Project({1, 0, z}).x() - camera.Project({-1, 0, z}).x();
  };
  const Camera flat = Camera::Fit(View(Projection::kOrthographic), points);
  EXPECT_NEAR(width_at(flat, 1), width_at(flat, -1), 1e-9);
  const Camera deep = Camera::Fit(View(Projection::kPerspective), points);
  EXPECT_GT(width_at(deep, 1), 1.05 * width_at(deep, -1));
}

TEST(CameraTest, TheViewerSeesDownTheCamerasAxis) {
  const Eigen::Matrix3Xd points = RandomMatrix(3, 10, 2);
  const Eigen::Vector3d middle = (points.rowwise().minCoeff() + points.rowwise().maxCoeff()) / 2;
  for (const Projection projection : {Projection::kOrthographic, Projection::kPerspective}) {
    const Camera camera = Camera::Fit(View(projection, 0, 0), points);
    EXPECT_LT(
        (Eigen::Vector3d(camera.camera_from_world().row(2).transpose()) - Eigen::Vector3d::UnitZ())
            .norm(),
        1e-9);
    EXPECT_NEAR(Eigen::Vector3d(camera.camera_from_world().row(2).transpose()).norm(), 1, 1e-12);
    const Eigen::Matrix3d r = camera.camera_from_world();
    EXPECT_LT((r * r.transpose() - Eigen::Matrix3d::Identity()).norm(), 1e-12);
    EXPECT_NEAR(r.determinant(), 1, 1e-12);
  }
  const Camera above = Camera::Fit(View(Projection::kOrthographic, 0, 90), points);
  EXPECT_LT(
      (Eigen::Vector3d(above.camera_from_world().row(2).transpose()) - Eigen::Vector3d::UnitY())
          .norm(),
      1e-9);
}

TEST(CameraTest, OnePointIsShownInTheMiddle) {
  const Eigen::Vector3d point(3, -2, 5);
  for (const Projection projection : {Projection::kOrthographic, Projection::kPerspective}) {
    const Eigen::Vector3d p = Camera::Fit(View(projection), point).Project(point);
    EXPECT_NEAR(p.x(), 150, 1e-6);
    EXPECT_NEAR(p.y(), 100, 1e-6);
    EXPECT_TRUE(p.allFinite());
  }
}

}  // namespace
}  // namespace pleat
