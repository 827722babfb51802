// Rows and columns of small pictures that share one camera and one scale.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "pleat/render/color_scale.h"
#include "pleat/render/render_mesh.h"

namespace pleat {

struct SheetTile {
  Eigen::Matrix3Xd positions;                   // 3 x V, meters
  const Eigen::Matrix3Xi* triangles = nullptr;  // 3 x F, must outlive the call
  std::vector<Rgb> vertex_colors;               // V, or empty
  double shading = 1;                           // as in RenderOptions
  std::optional<SkeletonOverlay> skeleton;
  std::string label;  // lower left corner, e.g. "frame 12"
};

struct ContactSheetOptions {
  int num_columns = 4;
  ViewOptions view{.width = 256, .height = 320};  // view of one tile
  // Every tile is moved so that its own center (x and z) is in the middle, which keeps traveling
  // characters large; the scale stays that of the largest tile.
  bool center_tiles = true;
  bool floor = true;  // grid at the lowest point of all tiles
  std::string title;
  std::vector<std::string> column_titles, row_titles;  // empty, or one per column / row
  std::optional<ColorScale> legend;
};

// Draws the tiles row by row; the last row may be short. The error is kInvalidArgument when there
// is no tile, a tile's sizes disagree, or the sheet would be larger than an image can be.
absl::StatusOr<Image> RenderContactSheet(const std::vector<SheetTile>& tiles,
                                         const ContactSheetOptions& options);

}  // namespace pleat
