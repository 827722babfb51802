#include "cli/show/error_sheet.h"

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "pleat/base/status.h"
#include "pleat/render/contact_sheet.h"

namespace pleat {
namespace {

constexpr double kMillimeters = 1000;

Eigen::VectorXd Distances_mm(const Eigen::Ref<const Eigen::Matrix3Xd>& positions,
                             const Eigen::Ref<const Eigen::Matrix3Xd>& truth) {
  return kMillimeters * (positions - truth).colwise().norm().transpose();
}

absl::Status CheckColumns(const MeshSequence& truth, const std::vector<int>& frame_numbers,
                          const std::vector<ErrorColumn>& columns,
                          const ErrorSheetOptions& options) {
  if (static_cast<int>(frame_numbers.size()) != truth.num_frames()) {
    return absl::InvalidArgumentError(absl::StrCat(
        "heat map: ", frame_numbers.size(), " frame numbers for ", truth.num_frames(), " frames"));
  }
  if (!(options.scale_mm > 0)) {
    return absl::InvalidArgumentError(
        absl::StrCat("heat map: a scale of ", options.scale_mm, " mm is not positive"));
  }
  for (const ErrorColumn& column : columns) {
    if (column.sequence.num_frames() == truth.num_frames() &&
        column.sequence.num_vertices() == truth.num_vertices()) {
      continue;
    }
    return absl::InvalidArgumentError(
        absl::StrCat("heat map: '", column.label, "' has ", column.sequence.num_frames(),
                     " frames of ", column.sequence.num_vertices(), " vertices, the truth ",
                     truth.num_frames(), " of ", truth.num_vertices()));
  }
  return absl::OkStatus();
}

}  // namespace

ColorScale ErrorScale(double scale_mm) {
  return {.map = ColorMap::kTurbo,
          .low = 0,
          .high = scale_mm,
          .title = absl::StrFormat("distance of each vertex from the input, %g and more at the end",
                                   scale_mm),
          .unit = "mm"};
}

std::vector<Rgb> ErrorColors(const ColorScale& scale,
                             const Eigen::Ref<const Eigen::Matrix3Xd>& positions,
                             const Eigen::Ref<const Eigen::Matrix3Xd>& truth) {
  return ColorValues(scale, Distances_mm(positions, truth));
}

absl::StatusOr<std::string> RenderErrorSheet(const MeshSequence& truth,
                                             const std::vector<int>& frame_numbers,
                                             const std::vector<ErrorColumn>& columns,
                                             const ErrorSheetOptions& options) {
  PLEAT_RETURN_IF_ERROR(CheckColumns(truth, frame_numbers, columns, options));
  const ColorScale scale = ErrorScale(options.scale_mm);
  ContactSheetOptions sheet;
  sheet.num_columns = static_cast<int>(columns.size()) + 1;
  sheet.view.width = options.tile_width;
  sheet.view.height = options.tile_height;
  sheet.view.azimuth_degrees = options.azimuth_degrees;
  sheet.legend = scale;
  for (const ErrorColumn& column : columns) sheet.column_titles.push_back(column.label);
  sheet.column_titles.emplace_back("input");
  std::vector<SheetTile> tiles;
  for (int t = 0; t < truth.num_frames(); ++t) {
    sheet.row_titles.push_back(absl::StrCat("frame ", frame_numbers[t]));
    const Eigen::Matrix3Xd expected = truth.FrameAsDouble(t);
    for (const ErrorColumn& column : columns) {
      SheetTile tile;
      tile.positions = column.sequence.FrameAsDouble(t);
      tile.triangles = &truth.topology().triangles();
      tile.vertex_colors = ErrorColors(scale, tile.positions, expected);
      tile.shading = 0;  // so that colors are exactly those of the legend
      const Eigen::VectorXd distances = Distances_mm(tile.positions, expected);
      tile.label =
          absl::StrFormat("mean %.1f mm, largest %.0f mm", distances.mean(), distances.maxCoeff());
      tiles.push_back(std::move(tile));
    }
    SheetTile tile;
    tile.positions = expected;
    tile.triangles = &truth.topology().triangles();
    tiles.push_back(std::move(tile));
  }
  PLEAT_ASSIGN_OR_RETURN(const Image image, RenderContactSheet(tiles, sheet));
  return EncodePng(image);
}

}  // namespace pleat
