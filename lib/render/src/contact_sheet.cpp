#include "pleat/render/contact_sheet.h"

#include <algorithm>
#include <cmath>

#include "absl/strings/str_cat.h"
#include "pleat/base/status.h"
#include "pleat/mesh/bounds.h"
#include "pleat/render/text.h"

namespace pleat {
namespace {

constexpr int kTextScale = 2, kSmallScale = 1, kGap = 4, kPadding = 6;
constexpr Rgb kInk{30, 30, 30}, kFrame{222, 222, 222};

absl::Status CheckTiles(const std::vector<SheetTile>& tiles, const ContactSheetOptions& options) {
  if (tiles.empty() || options.num_columns < 1) {
    return absl::InvalidArgumentError("contact sheet: needs at least one tile and one column");
  }
  if (options.view.width < 16 || options.view.height < 16 || options.view.width > 8192 ||
      options.view.height > 8192) {
    return absl::InvalidArgumentError(absl::StrCat("contact sheet: tiles of ", options.view.width,
                                                   " x ", options.view.height,
                                                   " pixels; each side must be 16 to 8192"));
  }
  for (size_t i = 0; i < tiles.size(); ++i) {
    const SheetTile& tile = tiles[i];
    const Eigen::Index num_vertices = tile.positions.cols();
    const bool fits =
        tile.triangles != nullptr && num_vertices > 0 &&
        (tile.triangles->size() == 0 ||
         (tile.triangles->minCoeff() >= 0 && tile.triangles->maxCoeff() < num_vertices)) &&
        (tile.vertex_colors.empty() ||
         static_cast<Eigen::Index>(tile.vertex_colors.size()) == num_vertices);
    if (!fits) {
      return absl::InvalidArgumentError(absl::StrCat(
          "contact sheet: positions, triangles and colors of tile ", i, " do not fit together"));
    }
  }
  return absl::OkStatus();
}

// Returns the positions of all tiles where they will be drawn, 3 x (sum of V): one camera is fitted
// to all of them.
Eigen::Matrix3Xd PlaceTiles(const std::vector<SheetTile>& tiles, bool center,
                            std::vector<Eigen::Vector3d>* shifts) {
  Eigen::Index total = 0;
  for (const SheetTile& tile : tiles) total += tile.positions.cols();
  Eigen::Matrix3Xd all(3, total);
  Eigen::Index column = 0;
  for (const SheetTile& tile : tiles) {
    Eigen::Vector3d shift = Eigen::Vector3d::Zero();
    if (center) {
      shift = -ComputeBounds(tile.positions).center();
      shift.y() = 0;  // heights above the floor stay comparable
    }
    all.middleCols(column, tile.positions.cols()) = tile.positions.colwise() + shift;
    column += tile.positions.cols();
    shifts->push_back(shift);
  }
  return all;
}

struct Layout {
  int num_columns, num_rows, left, top, tile_width, tile_height, width, height;

  int X(int i) const { return left + (i % num_columns) * (tile_width + kGap); }
  int Y(int i) const { return top + (i / num_columns) * (tile_height + kGap); }
};

Layout PlanLayout(int num_tiles, const ContactSheetOptions& options) {
  Layout layout;
  layout.num_columns = std::min(options.num_columns, num_tiles);
  layout.num_rows = (num_tiles + layout.num_columns - 1) / layout.num_columns;
  layout.tile_width = options.view.width;
  layout.tile_height = options.view.height;
  layout.left = kPadding;
  for (const std::string& title : options.row_titles) {
    layout.left = std::max(layout.left, TextWidth(title, kTextScale) + 2 * kPadding);
  }
  const int line = TextHeight(kTextScale) + kPadding;
  layout.top =
      kPadding + (options.title.empty() ? 0 : line) + (options.column_titles.empty() ? 0 : line);
  layout.width = layout.left + layout.num_columns * (layout.tile_width + kGap) + kPadding - kGap;
  layout.height = layout.top + layout.num_rows * (layout.tile_height + kGap) + kPadding - kGap;
  return layout;
}

Image RenderTile(const SheetTile& tile, const Eigen::Vector3d& shift, const Camera& camera,
                 std::optional<double> floor_y) {
  RenderOptions render;
  render.vertex_colors = tile.vertex_colors;
  render.shading = tile.shading;
  render.floor_y = floor_y;
  render.skeleton = tile.skeleton;
  if (render.skeleton) render.skeleton->joints.colwise() += shift;
  Image image = RenderMesh(tile.positions.colwise() + shift, *tile.triangles, camera, render);
  DrawText(&image, kPadding, image.height() - TextHeight(kSmallScale) - 2, tile.label, kSmallScale,
           kInk);
  return image;
}

void DrawTitles(const ContactSheetOptions& options, const Layout& layout, Image* sheet) {
  DrawText(sheet, kPadding, kPadding, options.title, kTextScale, kInk);
  const int column_y = layout.top - TextHeight(kTextScale) - 1;
  for (size_t c = 0; c < options.column_titles.size(); ++c) {
    const int x = layout.left + static_cast<int>(c) * (layout.tile_width + kGap);
    const int inset = (layout.tile_width - TextWidth(options.column_titles[c], kTextScale)) / 2;
    DrawText(sheet, x + std::max(inset, 0), column_y, options.column_titles[c], kTextScale, kInk);
  }
  for (size_t r = 0; r < options.row_titles.size(); ++r) {
    const int y = layout.top + static_cast<int>(r) * (layout.tile_height + kGap);
    DrawText(sheet, kPadding, y + (layout.tile_height - TextHeight(kTextScale)) / 2,
             options.row_titles[r], kTextScale, kInk);
  }
}

}  // namespace

absl::StatusOr<Image> RenderContactSheet(const std::vector<SheetTile>& tiles,
                                         const ContactSheetOptions& options) {
  PLEAT_RETURN_IF_ERROR(CheckTiles(tiles, options));
  const int num_tiles = static_cast<int>(tiles.size());
  const Layout layout = PlanLayout(num_tiles, options);
  std::optional<Image> legend;
  if (options.legend) legend = DrawColorLegend(*options.legend, std::min(layout.width, 420));
  const int height = layout.height + (legend ? legend->height() : 0);
  if (layout.width > Image::kMaxSide || height > Image::kMaxSide) {
    return absl::InvalidArgumentError(absl::StrCat("contact sheet: ", layout.width, " x ", height,
                                                   " pixels is more than ", Image::kMaxSide,
                                                   " a side; use fewer or smaller tiles"));
  }

  std::vector<Eigen::Vector3d> shifts;
  const Eigen::Matrix3Xd all = PlaceTiles(tiles, options.center_tiles, &shifts);
  const Camera camera = Camera::Fit(options.view, all);
  std::optional<double> floor_y;
  if (options.floor) floor_y = all.row(1).minCoeff();

  Image sheet(layout.width, height);
  for (int i = 0; i < num_tiles; ++i) {
    sheet.FillRectangle(layout.X(i) - 1, layout.Y(i) - 1, layout.tile_width + 2,
                        layout.tile_height + 2, kFrame);
    sheet.Paste(RenderTile(tiles[i], shifts[i], camera, floor_y), layout.X(i), layout.Y(i));
  }
  DrawTitles(options, layout, &sheet);
  if (legend) sheet.Paste(*legend, kPadding, layout.height);
  return sheet;
}

}  // namespace pleat
