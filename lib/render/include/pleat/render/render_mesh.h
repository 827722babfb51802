// Draws one frame in software: smooth shading, z-buffer, 2 x 2 supersampling, skeleton overlay.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "pleat/render/camera.h"
#include "pleat/render/image.h"

namespace pleat {

enum class BodySide { kMiddle, kLeft, kRight };

// Bones as lines and joints as dots, drawn over the mesh: left blue, right red, middle dark.
struct SkeletonOverlay {
  Eigen::Matrix3Xd joints;      // 3 x J, meters
  std::vector<int> parents;     // J, -1 for a root
  std::vector<BodySide> sides;  // J, or empty
};

struct RenderOptions {
  Rgb color{190, 192, 200};       // color of the mesh without vertex colors
  Rgb back_color{196, 130, 110};  // color of faces seen from behind
  Rgb background{255, 255, 255};
  std::vector<Rgb> vertex_colors;  // V, or empty
  // 1 is lit; 0 shows colors as they are, whose meaning light would change; between, both are
  // mixed.
  double shading = 1;
  std::optional<double> floor_y;  // draws a half-meter grid at this height, meters
  std::optional<SkeletonOverlay> skeleton;
};

// Draws a mesh. positions: 3 x V, meters; triangles: 3 x F, counter-clockwise from outside. The
// picture has the size of the camera's view.
Image RenderMesh(const Eigen::Ref<const Eigen::Matrix3Xd>& positions,
                 const Eigen::Ref<const Eigen::Matrix3Xi>& triangles, const Camera& camera,
                 const RenderOptions& options = {});

}  // namespace pleat
