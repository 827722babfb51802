#include "cli/show/error_sheet.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <tuple>

#include "client/test_sequence.h"
#include "pleat/render/contact_sheet.h"
#include "support/status_matchers.h"

namespace pleat {
namespace {

using ::testing::Each;
using ::testing::HasSubstr;
using ::testing::StartsWith;

TEST(ErrorSheet, AMeshMovedByTenMillimetersHasTheColorOfTenMillimeters) {
  const MeshSequence truth = MovingTetrahedron(2);
  const ColorScale scale = ErrorScale(25);
  const Rgb ten = MapColor(ColorMap::kTurbo, 10. / 25);
  for (const Eigen::Vector3f& by :
       {Eigen::Vector3f(.01f, 0, 0), Eigen::Vector3f(0, -.006f, .008f)}) {
    const MeshSequence moved = Moved(truth, by);
    EXPECT_THAT(ErrorColors(scale, moved.FrameAsDouble(1), truth.FrameAsDouble(1)), Each(ten));
  }
  // Every vertex its own distance: 0 .. 3 x 8 mm, and 80 mm as the end of the scale.
  Eigen::Matrix3Xd positions = truth.FrameAsDouble(0);
  for (int v = 0; v < 4; ++v) positions(1, v) += v < 3 ? .008 * v : .08;
  const std::vector<Rgb> colors = ErrorColors(scale, positions, truth.FrameAsDouble(0));
  EXPECT_EQ(colors[0], scale(0));
  EXPECT_EQ(colors[1], scale(8));
  EXPECT_EQ(colors[2], scale(16));
  EXPECT_EQ(colors[3], scale(25));
}

// The most frequent color of a tile that is not its white background.
Rgb MainColor(const Image& image) {
  std::map<std::tuple<int, int, int>, int> counts;
  for (const Rgb& pixel : image.pixels()) ++counts[{pixel.r, pixel.g, pixel.b}];
  counts.erase({255, 255, 255});
  auto most = counts.begin();
  for (auto it = counts.begin(); it != counts.end(); ++it) {
    if (it->second > most->second) most = it;
  }
  const auto& [r, g, b] = most->first;
  return {static_cast<uint8_t>(r), static_cast<uint8_t>(g), static_cast<uint8_t>(b)};
}

TEST(ErrorSheet, ThePictureShowsTheColorOfTheLegend) {
  const MeshSequence truth = MovingTetrahedron(1);
  const ColorScale scale = ErrorScale(25);
  for (const double error_mm : {0., 10., 20., 100.}) {
    const MeshSequence moved =
        Moved(truth, Eigen::Vector3f(0, static_cast<float>(error_mm / 1000), 0));
    SheetTile tile;
    tile.positions = moved.FrameAsDouble(0);
    tile.triangles = &truth.topology().triangles();
    tile.vertex_colors = ErrorColors(scale, tile.positions, truth.FrameAsDouble(0));
    tile.shading = 0;
    ContactSheetOptions sheet;
    sheet.floor = false;
    PLEAT_ASSERT_OK_AND_ASSIGN(const Image image, RenderContactSheet({tile}, sheet));
    const Rgb shown = MainColor(image), expected = scale(std::min(error_mm, 25.));
    EXPECT_NEAR(shown.r, expected.r, 1) << error_mm;
    EXPECT_NEAR(shown.g, expected.g, 1) << error_mm;
    EXPECT_NEAR(shown.b, expected.b, 1) << error_mm;
  }
}

TEST(ErrorSheet, DrawsARowForEachFrame) {
  const MeshSequence truth = MovingTetrahedron(3);
  const std::vector<ErrorColumn> columns = {{"skinned only", Moved(truth, {.01f, 0, 0})},
                                            {"hybrid", Moved(truth, {.001f, 0, 0})}};
  PLEAT_ASSERT_OK_AND_ASSIGN(
      const std::string png,
      RenderErrorSheet(truth, {0, 4, 9}, columns, {.tile_width = 64, .tile_height = 64}));
  EXPECT_THAT(png, StartsWith("\x89PNG"));
}

TEST(ErrorSheet, RefusesWhatDoesNotFit) {
  const MeshSequence truth = MovingTetrahedron(3);
  EXPECT_THAT(RenderErrorSheet(truth, {0, 1}, {}, {}),
              HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("frame numbers")));
  EXPECT_THAT(RenderErrorSheet(truth, {0, 1, 2}, {{"short", MovingTetrahedron(2)}}, {}),
              HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("'short' has 2 frames")));
  EXPECT_THAT(RenderErrorSheet(truth, {0, 1, 2}, {{"same", truth}}, {.scale_mm = 0}),
              HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("scale")));
}

}  // namespace
}  // namespace pleat
