#include "cli/show/rig_sheet.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cctype>
#include <numbers>

#include "absl/strings/ascii.h"
#include "absl/strings/match.h"
#include "pleat/base/status.h"
#include "pleat/mesh/bounds.h"
#include "pleat/render/contact_sheet.h"

namespace pleat {
namespace {

constexpr Rgb kPaleMesh{224, 226, 232};

bool EndsInLetter(const std::string& name, char letter) {
  const size_t size = name.size();
  return size >= 2 && name[size - 1] == letter && std::ispunct(name[size - 2]) != 0;
}

bool BeginsWithLetter(const std::string& name, char letter) {
  return name.size() >= 2 && name[0] == letter && std::ispunct(name[1]) != 0;
}

// The character, turned to face the viewer at +z and scaled to height 1, with its feet at y = 0.
struct Turned {
  Eigen::Matrix3Xd positions, joints;
};

Turned TurnToViewer(const RigSheetRow::View& view, double turn_degrees) {
  const Eigen::Matrix3d turn =
      Eigen::AngleAxisd(-turn_degrees * std::numbers::pi / 180, Eigen::Vector3d::UnitY())
          .toRotationMatrix();
  const Eigen::AlignedBox3d bounds = ComputeBounds(view.positions);
  const double scale = 1 / std::max(bounds.sizes().maxCoeff(), 1e-12);
  Eigen::Vector3d foot = bounds.center();
  foot.y() = bounds.min().y();
  return {scale * (turn * (view.positions.colwise() - foot)),
          scale * (turn * (view.joints.colwise() - foot))};
}

}  // namespace

std::vector<BodySide> SidesOfJoints(const Skeleton& skeleton) {
  std::vector<BodySide> sides;
  for (const Joint& joint : skeleton.joints()) {
    const std::string name = absl::AsciiStrToLower(joint.name);
    const auto is_of = [&name](const char* word) {
      return absl::StrContains(name, word) || EndsInLetter(name, word[0]) ||
             BeginsWithLetter(name, word[0]);
    };
    const bool left = is_of("left"), right = is_of("right");
    sides.push_back(left == right ? BodySide::kMiddle : left ? BodySide::kLeft : BodySide::kRight);
  }
  return sides;
}

absl::StatusOr<std::string> RenderRigSheet(const std::vector<RigSheetRow>& rows,
                                           const RigSheetOptions& options) {
  size_t num_views = 0;
  for (const RigSheetRow& row : rows) num_views = std::max(num_views, row.views.size());
  ContactSheetOptions sheet;
  sheet.num_columns = static_cast<int>(2 * num_views);
  sheet.view.width = options.tile_width;
  sheet.view.height = options.tile_height;
  for (size_t k = 0; k < num_views; ++k) {
    sheet.column_titles.push_back("front");
    sheet.column_titles.push_back("left side");
  }
  std::vector<SheetTile> tiles;
  for (const RigSheetRow& row : rows) {
    sheet.row_titles.push_back(row.label);
    std::vector<int> parents;
    for (const Joint& joint : row.skeleton.joints()) parents.push_back(joint.parent);
    const std::vector<BodySide> sides = SidesOfJoints(row.skeleton);
    // Rows with fewer frames repeat their last one.
    for (size_t k = 0; k < 2 * num_views; ++k) {
      const RigSheetRow::View& view = row.views[std::min(k / 2, row.views.size() - 1)];
      const Turned turned = TurnToViewer(view, row.yaw_degrees + (k % 2 == 0 ? 0 : 90));
      SheetTile tile;
      tile.positions = turned.positions;
      tile.triangles = &row.topology.triangles();
      tile.vertex_colors.assign(turned.positions.cols(), kPaleMesh);
      tile.skeleton = SkeletonOverlay{turned.joints, parents, sides};
      tile.label = view.label;
      tiles.push_back(std::move(tile));
    }
  }
  PLEAT_ASSIGN_OR_RETURN(const Image image, RenderContactSheet(tiles, sheet));
  return EncodePng(image);
}

}  // namespace pleat
