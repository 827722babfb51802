// Half-space rasterization (Pineda 1988) at twice the resolution, averaged 2 x 2. The depth of a
// camera is linear over the picture, so it is interpolated like a plane; normals and colors are
// interpolated the same way, which is slightly wrong under perspective and does not show at the
// size of a mesh's triangles. It uses no threads.
#include "pleat/render/render_mesh.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

#include "pleat/mesh/normals.h"

namespace pleat {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

constexpr int kSamples = 2;  // per pixel and axis

struct ProjectedVertex {
  float x, y, depth;
  Vector3f normal;  // camera axes
  Vector3f color;   // 0..255
};

// A key light from the upper left, a fill light from the right, and a little from above, all in
// camera axes, so that a character is lit alike from every side.
Rgb Shade(const Vector3f& color, const Vector3f& normal, float shading) {
  static const Vector3f kKey = Vector3f(-.45f, .60f, .66f).normalized();
  static const Vector3f kFill = Vector3f(.80f, .10f, .60f).normalized();
  const float light = .30f + .08f * normal.y() + .62f * std::max(0.f, normal.dot(kKey)) +
                      .20f * std::max(0.f, normal.dot(kFill));
  const float factor = 1 + shading * (light * 1.12f - 1);
  const Vector3f lit = (color * factor).cwiseMin(255.f).cwiseMax(0.f);
  return {static_cast<uint8_t>(lit.x()), static_cast<uint8_t>(lit.y()),
          static_cast<uint8_t>(lit.z())};
}

class Rasterizer {
 public:
  Rasterizer(int width, int height, Rgb background)
      : image_(width * kSamples, height * kSamples, background),
        depth_(static_cast<size_t>(image_.width()) * image_.height(),
               std::numeric_limits<float>::infinity()) {}

  void DrawTriangle(const ProjectedVertex& a, const ProjectedVertex& b, const ProjectedVertex& c,
                    const Vector3f& back_color, float shading);
  // Draws a line that is hidden where the mesh is nearer; its ends are in samples, with depth.
  void DrawHiddenLine(const Vector3d& from, const Vector3d& to, Rgb color);
  Image Downsample() const;

 private:
  Image image_;
  std::vector<float> depth_;
};

void Rasterizer::DrawTriangle(const ProjectedVertex& a, const ProjectedVertex& b,
                              const ProjectedVertex& c, const Vector3f& back_color, float shading) {
  // y runs down, so a counter-clockwise (front) face has negative area here.
  const float area = (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
  if (area == 0) return;
  const bool front = area < 0;
  const float low_x = std::min({a.x, b.x, c.x}), high_x = std::max({a.x, b.x, c.x});
  const float low_y = std::min({a.y, b.y, c.y}), high_y = std::max({a.y, b.y, c.y});
  // Sample centers lie at half numbers.
  const int left = std::max(0, static_cast<int>(std::ceil(low_x - .5f)));
  const int right = std::min(image_.width() - 1, static_cast<int>(std::floor(high_x - .5f)));
  const int top = std::max(0, static_cast<int>(std::ceil(low_y - .5f)));
  const int bottom = std::min(image_.height() - 1, static_cast<int>(std::floor(high_y - .5f)));
  const float inverse = 1 / area;
  for (int y = top; y <= bottom; ++y) {
    for (int x = left; x <= right; ++x) {
      const float px = x + .5f, py = y + .5f;
      const float u = ((b.x - px) * (c.y - py) - (b.y - py) * (c.x - px)) * inverse;
      const float v = ((c.x - px) * (a.y - py) - (c.y - py) * (a.x - px)) * inverse;
      const float w = 1 - u - v;
      if (u < 0 || v < 0 || w < 0) continue;
      const float depth = u * a.depth + v * b.depth + w * c.depth;
      float& nearest = depth_[static_cast<size_t>(y) * image_.width() + x];
      if (depth >= nearest) continue;
      nearest = depth;
      const Vector3f normal = (u * a.normal + v * b.normal + w * c.normal).normalized();
      const Vector3f color = u * a.color + v * b.color + w * c.color;
      image_.at(x, y) =
          front ? Shade(color, normal, shading) : Shade(back_color, Vector3f(-normal), 1);
    }
  }
}

void Rasterizer::DrawHiddenLine(const Vector3d& from, const Vector3d& to, Rgb color) {
  const int steps = std::max(1, static_cast<int>(std::ceil((to - from).head<2>().norm())));
  if (steps > 4 * (image_.width() + image_.height())) return;  // it runs far out of the picture
  for (int i = 0; i <= steps; ++i) {
    const Vector3d p = from + (to - from) * i / steps;
    const int x = static_cast<int>(std::floor(p.x())), y = static_cast<int>(std::floor(p.y()));
    if (!image_.Contains(x, y)) continue;
    const size_t index = static_cast<size_t>(y) * image_.width() + x;
    if (p.z() < depth_[index]) image_.at(x, y) = color;
  }
}

Image Rasterizer::Downsample() const {
  Image small(image_.width() / kSamples, image_.height() / kSamples);
  for (int y = 0; y < small.height(); ++y) {
    for (int x = 0; x < small.width(); ++x) {
      int r = 0, g = 0, b = 0;
      for (int i = 0; i < kSamples * kSamples; ++i) {
        const Rgb& sample = image_.at(kSamples * x + i % kSamples, kSamples * y + i / kSamples);
        r += sample.r;
        g += sample.g;
        b += sample.b;
      }
      constexpr int kCount = kSamples * kSamples;
      small.at(x, y) = {static_cast<uint8_t>((r + kCount / 2) / kCount),
                        static_cast<uint8_t>((g + kCount / 2) / kCount),
                        static_cast<uint8_t>((b + kCount / 2) / kCount)};
    }
  }
  return small;
}

void DrawFloor(const Eigen::Ref<const Eigen::Matrix3Xd>& positions, double floor_y,
               const Camera& camera, Rasterizer* rasterizer) {
  constexpr double kCell_m = .5;
  const Rgb line_color{205, 205, 205};
  const Vector3d low = positions.rowwise().minCoeff(), high = positions.rowwise().maxCoeff();
  const int x0 = static_cast<int>(std::floor(low.x() / kCell_m)) - 1;
  const int x1 = static_cast<int>(std::ceil(high.x() / kCell_m)) + 1;
  const int z0 = static_cast<int>(std::floor(low.z() / kCell_m)) - 1;
  const int z1 = static_cast<int>(std::ceil(high.z() / kCell_m)) + 1;
  if (static_cast<int64_t>(x1) - x0 + z1 - z0 > 1000) return;  // not a scene in meters
  const auto project = [&](int x, int z) {
    Vector3d p = camera.Project(Vector3d(x * kCell_m, floor_y, z * kCell_m));
    p.head<2>() *= kSamples;
    return p;
  };
  for (int x = x0; x <= x1; ++x) {
    rasterizer->DrawHiddenLine(project(x, z0), project(x, z1), line_color);
  }
  for (int z = z0; z <= z1; ++z) {
    rasterizer->DrawHiddenLine(project(x0, z), project(x1, z), line_color);
  }
}

void DrawSkeleton(const SkeletonOverlay& skeleton, const Camera& camera, Image* image) {
  const auto color = [&](int j) -> Rgb {
    if (skeleton.sides.empty() || skeleton.sides[j] == BodySide::kMiddle) return {40, 40, 40};
    return skeleton.sides[j] == BodySide::kLeft ? Rgb{30, 80, 220} : Rgb{215, 40, 40};
  };
  const double unit = std::max(1.0, image->height() / 300.);
  const int num_joints = static_cast<int>(skeleton.joints.cols());
  for (int j = 0; j < num_joints; ++j) {
    if (skeleton.parents[j] < 0) continue;
    const Vector3d a = camera.Project(skeleton.joints.col(skeleton.parents[j]));
    const Vector3d b = camera.Project(skeleton.joints.col(j));
    image->DrawLine(a.x(), a.y(), b.x(), b.y(), 1.6 * unit, color(j));
  }
  for (int j = 0; j < num_joints; ++j) {
    const Vector3d p = camera.Project(skeleton.joints.col(j));
    image->DrawDot(p.x(), p.y(), 2.6 * unit, {255, 255, 255});
    image->DrawDot(p.x(), p.y(), 1.9 * unit, color(j));
  }
}

}  // namespace

Image RenderMesh(const Eigen::Ref<const Eigen::Matrix3Xd>& positions,
                 const Eigen::Ref<const Eigen::Matrix3Xi>& triangles, const Camera& camera,
                 const RenderOptions& options) {
  const int num_vertices = static_cast<int>(positions.cols());
  assert(options.vertex_colors.empty() ||
         static_cast<int>(options.vertex_colors.size()) == num_vertices);
  const auto to_vector = [](Rgb c) { return Vector3f(c.r, c.g, c.b); };
  const Eigen::Matrix3Xf normals =
      (camera.camera_from_world() * SumTriangleNormals(positions, triangles))
          .colwise()
          .normalized()
          .cast<float>();
  std::vector<ProjectedVertex> vertices(num_vertices);
  for (int v = 0; v < num_vertices; ++v) {
    const Vector3d p = camera.Project(positions.col(v));
    vertices[v] = {
        static_cast<float>(p.x() * kSamples), static_cast<float>(p.y() * kSamples),
        static_cast<float>(p.z()), normals.col(v),
        to_vector(options.vertex_colors.empty() ? options.color : options.vertex_colors[v])};
  }
  Rasterizer rasterizer(camera.view().width, camera.view().height, options.background);
  const Vector3f back_color = to_vector(options.back_color);
  for (int f = 0; f < triangles.cols(); ++f) {
    rasterizer.DrawTriangle(vertices[triangles(0, f)], vertices[triangles(1, f)],
                            vertices[triangles(2, f)], back_color,
                            static_cast<float>(options.shading));
  }
  if (options.floor_y) DrawFloor(positions, *options.floor_y, camera, &rasterizer);
  Image image = rasterizer.Downsample();
  if (options.skeleton) DrawSkeleton(*options.skeleton, camera, &image);
  return image;
}

}  // namespace pleat
