#include "pleat/render/contact_sheet.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/status_matchers.h"

namespace pleat {
namespace {

using ::testing::HasSubstr;

const Eigen::Matrix3Xi& Triangles() {
  static const Eigen::Matrix3Xi triangles = Eigen::Vector3i(0, 1, 2);
  return triangles;
}

SheetTile TriangleTile(double x) {
  SheetTile tile;
  tile.positions.resize(3, 3);
  tile.positions << x, x + 1, x,  //
      0, 0, 1,                    //
      0, 0, 0;
  tile.triangles = &Triangles();
  return tile;
}

ContactSheetOptions SmallTiles() {
  ContactSheetOptions options;
  options.num_columns = 3;
  options.view.width = 80;
  options.view.height = 60;
  return options;
}

TEST(ContactSheet, HasRoomForAllTilesAndTitles) {
  std::vector<SheetTile> tiles(7, TriangleTile(0));
  ContactSheetOptions options = SmallTiles();
  PLEAT_ASSERT_OK_AND_ASSIGN(const Image plain, RenderContactSheet(tiles, options));
  EXPECT_GE(plain.width(), 3 * 80);
  EXPECT_LT(plain.width(), 3 * 80 + 40);
  EXPECT_GE(plain.height(), 3 * 60);
  EXPECT_LT(plain.height(), 3 * 60 + 40);
  options.title = "title";
  options.column_titles = {"a", "b", "c"};
  options.row_titles = {"input", "skinned", "hybrid"};
  options.legend = ColorScale{};
  PLEAT_ASSERT_OK_AND_ASSIGN(const Image titled, RenderContactSheet(tiles, options));
  EXPECT_GT(titled.width(), plain.width() + 40);
  EXPECT_GT(titled.height(), plain.height() + 60);
  options.num_columns = 20;  // fewer tiles than columns: one row
  options.column_titles.clear();
  options.row_titles.clear();
  PLEAT_ASSERT_OK_AND_ASSIGN(const Image row, RenderContactSheet(tiles, options));
  EXPECT_LT(row.width(), 8 * 84);
}

TEST(ContactSheet, CenteredTilesLookAlikeWhereverTheCharacterIs) {
  std::vector<SheetTile> tiles = {TriangleTile(0), TriangleTile(50)};
  ContactSheetOptions options = SmallTiles();
  options.num_columns = 2;
  PLEAT_ASSERT_OK_AND_ASSIGN(const Image sheet, RenderContactSheet(tiles, options));
  int differing = 0;
  for (int y = 0; y < 60; ++y) {
    for (int x = 0; x < 80; ++x) {
      differing += !(sheet.at(6 + x, 6 + y) == sheet.at(6 + 84 + x, 6 + y));
    }
  }
  EXPECT_LT(differing, 80 * 60 / 50);
}

TEST(ContactSheet, RefusesWhatDoesNotFitTogether) {
  EXPECT_THAT(RenderContactSheet({}, SmallTiles()),
              HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("at least one tile")));
  SheetTile tile = TriangleTile(0);
  tile.vertex_colors.assign(2, Rgb{});
  EXPECT_THAT(RenderContactSheet({tile}, SmallTiles()),
              HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("tile 0")));
  tile = TriangleTile(0);
  tile.positions.conservativeResize(3, 2);  // triangle names vertex 2
  EXPECT_THAT(RenderContactSheet({tile}, SmallTiles()),
              HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("tile 0")));
  ContactSheetOptions options = SmallTiles();
  options.num_columns = 1;
  options.view.height = 8000;
  EXPECT_THAT(RenderContactSheet(std::vector<SheetTile>(5, TriangleTile(0)), options),
              HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("smaller tiles")));
}

}  // namespace
}  // namespace pleat
