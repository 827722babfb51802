#include "pleat/render/color_scale.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

namespace pleat {
namespace {

double Luminance(Rgb c) { return .2126 * c.r + .7152 * c.g + .0722 * c.b; }

TEST(ColorScale, ViridisRisesInBrightness) {
  double previous = -1;
  for (int i = 0; i <= 50; ++i) {
    const double luminance = Luminance(MapColor(ColorMap::kViridis, i / 50.));
    EXPECT_GT(luminance, previous);
    previous = luminance;
  }
}

TEST(ColorScale, ClampsAndSurvivesNan) {
  for (ColorMap map : {ColorMap::kViridis, ColorMap::kTurbo}) {
    EXPECT_EQ(MapColor(map, -3), MapColor(map, 0));
    EXPECT_EQ(MapColor(map, 7), MapColor(map, 1));
    EXPECT_EQ(MapColor(map, std::nan("")), MapColor(map, 0));
  }
}

TEST(ColorScale, ColorsValuesByTheirPlaceInTheRange) {
  ColorScale scale;
  scale.low = 2;
  scale.high = 12;
  const std::vector<Rgb> colors = ColorValues(scale, Eigen::Vector3d(2, 7, 12));
  EXPECT_EQ(colors[0], MapColor(scale.map, 0));
  EXPECT_EQ(colors[1], MapColor(scale.map, .5));
  EXPECT_EQ(colors[2], MapColor(scale.map, 1));
}

TEST(ColorScale, LegendShowsBarAndLabels) {
  ColorScale scale;
  scale.high = 25;
  scale.title = "distance";
  const Image legend = DrawColorLegend(scale, 300);
  EXPECT_EQ(legend.width(), 300);
  std::set<int> colors;
  for (int x = 30; x < 270; ++x) {
    const Rgb c = legend.at(x, 20);
    colors.insert(c.r << 16 | c.g << 8 | c.b);
  }
  EXPECT_GT(colors.size(), 100u);
  int ink_below = 0;
  for (int y = 34; y < legend.height(); ++y) {
    for (int x = 0; x < 300; ++x) ink_below += legend.at(x, y) != Rgb{255, 255, 255};
  }
  EXPECT_GT(ink_below, 50);
}

}  // namespace
}  // namespace pleat
