#include "rig_picture.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "pleat/base/file.h"
#include "pleat/render/contact_sheet.h"
#include "pleat/skeleton/human_template.h"

namespace pleat {

void DrawRig(const std::string& name, const Eigen::Matrix3Xi& triangles, const Rig& rig,
             const AutoRigSummary& summary, const std::string& folder) {
  std::vector<SheetTile> tiles;
  std::vector<int> parents;
  std::vector<BodySide> sides;
  for (int j = 0; j < kNumHumanJoints; ++j) {
    parents.push_back(HumanTemplate().parent(j));
    sides.push_back(HumanMirror()[j] == j  ? BodySide::kMiddle
                    : HumanMirror()[j] > j ? BodySide::kLeft
                                           : BodySide::kRight);
  }
  const Eigen::Matrix3d upright =
      Eigen::Quaterniond::FromTwoVectors(summary.up, Eigen::Vector3d::UnitY()).toRotationMatrix();
  for (const double turn_degrees : {0., 90.}) {
    const Eigen::Matrix3d turn =
        Eigen::AngleAxisd(-(summary.yaw_degrees + turn_degrees) * EIGEN_PI / 180,
                          Eigen::Vector3d::UnitY()) *
        upright;
    SheetTile tile;
    tile.positions = turn * rig.rest_positions;
    tile.triangles = &triangles;
    tile.vertex_colors.assign(tile.positions.cols(), Rgb{224, 226, 232});
    tile.skeleton = SkeletonOverlay{turn * rig.skeleton.RestPositions(), parents, sides};
    tile.label = absl::StrCat(name, turn_degrees == 0 ? " front" : " left");
    tiles.push_back(std::move(tile));
  }
  ContactSheetOptions sheet;
  sheet.num_columns = 2;
  sheet.view.width = 320;
  sheet.view.height = 400;
  std::string file = name;
  std::ranges::replace(file, ' ', '_');
  const absl::StatusOr<Image> image = RenderContactSheet(tiles, sheet);
  if (image.ok()) (void)WriteFile(absl::StrCat(folder, "/", file, ".png"), EncodePng(*image));
}

}  // namespace pleat
