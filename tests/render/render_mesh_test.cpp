#include "pleat/render/render_mesh.h"

#include <gtest/gtest.h>

namespace pleat {
namespace {

const Rgb kWhite{255, 255, 255};

ViewOptions FrontView(int size) {
  ViewOptions view;
  view.width = view.height = size;
  view.projection = Projection::kOrthographic;
  view.elevation_degrees = 0;
  view.margin = 0;
  return view;
}

// A unit square in the plane z, facing +z.
Eigen::Matrix3Xd Square(double z) {
  Eigen::Matrix3Xd square(3, 4);
  square << 0, 1, 1, 0,  //
      0, 0, 1, 1,        //
      z, z, z, z;
  return square;
}

TEST(RenderMesh, TriangleCoversTheExpectedPixels) {
  const Eigen::Matrix3Xd positions = Square(0);
  const Camera camera = Camera::Fit(FrontView(64), positions);
  // Lower right half: corners (0,0), (1,0), (1,1); y is up in the world, down in the image.
  const Eigen::Matrix3Xi triangles = Eigen::Vector3i(0, 1, 2);
  const Image image = RenderMesh(positions, triangles, camera);
  int covered = 0;
  for (int y = 0; y < 64; ++y) {
    for (int x = 0; x < 64; ++x) {
      const bool is_mesh = !(image.at(x, y) == kWhite);
      covered += is_mesh;
      if (x > 63 - y + 1) {
        EXPECT_TRUE(is_mesh) << x << " " << y;
      }
      if (x < 63 - y - 1) {
        EXPECT_FALSE(is_mesh) << x << " " << y;
      }
    }
  }
  EXPECT_NEAR(covered, 64 * 64 / 2, 64);
}

TEST(RenderMesh, NearFacesHideFarOnesInAnyOrder) {
  Eigen::Matrix3Xd positions(3, 8);
  positions << Square(0), Square(1);  // second square nearer to a viewer at +z
  Eigen::Matrix3Xi far_first(3, 4), near_first(3, 4);
  far_first << 0, 0, 4, 4,  //
      1, 2, 5, 6,           //
      2, 3, 6, 7;
  near_first << far_first.rightCols(2), far_first.leftCols(2);
  RenderOptions options;
  options.vertex_colors.assign(4, Rgb{200, 0, 0});
  options.vertex_colors.insert(options.vertex_colors.end(), 4, Rgb{0, 200, 0});
  for (Projection projection : {Projection::kOrthographic, Projection::kPerspective}) {
    ViewOptions view = FrontView(32);
    view.projection = projection;
    const Camera camera = Camera::Fit(view, positions);
    const Image first = RenderMesh(positions, far_first, camera, options);
    const Image second = RenderMesh(positions, near_first, camera, options);
    EXPECT_GT(first.at(16, 16).g, 50);
    EXPECT_EQ(first.at(16, 16).r, 0);
    EXPECT_EQ(first.pixels(), second.pixels());
  }
}

TEST(RenderMesh, BackFacesHaveTheirOwnColor) {
  const Eigen::Matrix3Xd positions = Square(0);
  Eigen::Matrix3Xi front(3, 2), back(3, 2);
  front << 0, 0, 1, 2, 2, 3;
  back << 0, 0, 2, 3, 1, 2;
  RenderOptions options;
  options.color = {0, 0, 200};
  options.back_color = {200, 0, 0};
  const Camera camera = Camera::Fit(FrontView(32), positions);
  const Rgb seen_front = RenderMesh(positions, front, camera, options).at(16, 16);
  const Rgb seen_back = RenderMesh(positions, back, camera, options).at(16, 16);
  EXPECT_GT(seen_front.b, 50);
  EXPECT_EQ(seen_front.r, 0);
  EXPECT_GT(seen_back.r, 50);
  EXPECT_EQ(seen_back.b, 0);
}

TEST(RenderMesh, SkeletonIsDrawnOverTheMeshLeftBlueRightRed) {
  const Eigen::Matrix3Xd positions = Square(0);
  Eigen::Matrix3Xi triangles(3, 2);
  triangles << 0, 0, 1, 2, 2, 3;
  RenderOptions options;
  SkeletonOverlay skeleton;
  skeleton.joints.resize(3, 3);
  skeleton.joints << .5, .2, .8,  //
      .5, .5, .5,                 //
      -1, -1, -1;                 // behind the square
  skeleton.parents = {-1, 0, 0};
  skeleton.sides = {BodySide::kMiddle, BodySide::kRight, BodySide::kLeft};
  options.skeleton = skeleton;
  const Camera camera = Camera::Fit(FrontView(100), positions);
  const Image image = RenderMesh(positions, triangles, camera, options);
  EXPECT_GT(image.at(20, 50).r, 150);
  EXPECT_LT(image.at(20, 50).b, 100);
  EXPECT_GT(image.at(80, 50).b, 150);
  EXPECT_LT(image.at(80, 50).r, 100);
}

TEST(RenderMesh, FloorGridStaysBehindTheMesh) {
  Eigen::Matrix3Xd positions = Square(0);
  Eigen::Matrix3Xi triangles(3, 2);
  triangles << 0, 0, 1, 2, 2, 3;
  ViewOptions view = FrontView(128);
  view.elevation_degrees = 20;
  view.margin = .2;
  RenderOptions options;
  const Camera camera = Camera::Fit(view, positions);
  const Image without = RenderMesh(positions, triangles, camera, options);
  options.floor_y = 0;
  const Image with = RenderMesh(positions, triangles, camera, options);
  EXPECT_EQ(without.at(64, 50), with.at(64, 50));  // in the square
  EXPECT_NE(without.pixels(), with.pixels());      // lines beside it
}

TEST(Camera, FitsAllPointsInBothProjectionsFromAnySide) {
  Eigen::Matrix3Xd points(3, 5);
  points << 0, 1, .3, -.5, .2,  //
      0, 2, 1, .3, 1.7,         //
      0, .3, -.6, 1, .2;
  for (Projection projection : {Projection::kOrthographic, Projection::kPerspective}) {
    for (double azimuth : {0., 75., 180., 290.}) {
      ViewOptions view;
      view.width = 200;
      view.height = 320;
      view.projection = projection;
      view.azimuth_degrees = azimuth;
      const Camera camera = Camera::Fit(view, points);
      for (int i = 0; i < points.cols(); ++i) {
        const Eigen::Vector3d pixel = camera.Project(points.col(i));
        EXPECT_GE(pixel.x(), .05 * 200 - .5);
        EXPECT_LE(pixel.x(), .95 * 200 + .5);
        EXPECT_GE(pixel.y(), .05 * 320 - .5);
        EXPECT_LE(pixel.y(), .95 * 320 + .5);
      }
    }
  }
}

TEST(Camera, AzimuthNinetyLooksAtTheSideThatFacesPlusX) {
  ViewOptions view = FrontView(100);
  view.azimuth_degrees = 90;
  const Camera camera = Camera::Fit(view, Square(0));
  EXPECT_LT((camera.camera_from_world().row(2) - Eigen::RowVector3d::UnitX()).norm(), 1e-12);
  EXPECT_LT(camera.Project(Eigen::Vector3d(5, 0, 0)).z(),
            camera.Project(Eigen::Vector3d(0, 0, 0)).z());
}

}  // namespace
}  // namespace pleat
