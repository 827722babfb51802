#include "pleat/render/colour_scale.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

namespace pleat {
namespace {

double Luminance(Rgb c) { return .2126 * c.r + .7152 * c.g + .0722 * c.b; }

TEST(ColourScale, ViridisRisesInBrightness) {
  double previous = -1;
  for (int i = 0; i <= 50; ++i) {
    const double luminance = Luminance(MapColour(ColourMap::kViridis, i / 50.));
    EXPECT_GT(luminance, previous);
    previous = luminance;
  }
}

TEST(ColourScale, ClampsAndSurvivesNan) {
  for (ColourMap map : {ColourMap::kViridis, ColourMap::kTurbo}) {
    EXPECT_EQ(MapColour(map, -3), MapColour(map, 0));
    EXPECT_EQ(MapColour(map, 7), MapColour(map, 1));
    EXPECT_EQ(MapColour(map, std::nan("")), MapColour(map, 0));
  }
}

TEST(ColourScale, ColoursValuesByTheirPlaceInTheRange) {
  ColourScale scale;
  scale.low = 2;
  scale.high = 12;
  const std::vector<Rgb> colours = ColourValues(scale, Eigen::Vector3d(2, 7, 12));
  EXPECT_EQ(colours[0], MapColour(scale.map, 0));
  EXPECT_EQ(colours[1], MapColour(scale.map, .5));
  EXPECT_EQ(colours[2], MapColour(scale.map, 1));
}

TEST(ColourScale, LegendShowsBarAndLabels) {
  ColourScale scale;
  scale.high = 25;
  scale.title = "distance";
  const Image legend = DrawColourLegend(scale, 300);
  EXPECT_EQ(legend.width(), 300);
  std::set<int> colours;
  for (int x = 30; x < 270; ++x) {
    const Rgb c = legend.at(x, 20);
    colours.insert(c.r << 16 | c.g << 8 | c.b);
  }
  EXPECT_GT(colours.size(), 100u);
  int ink_below = 0;
  for (int y = 34; y < legend.height(); ++y) {
    for (int x = 0; x < 300; ++x) ink_below += legend.at(x, y) == Rgb{40, 40, 40};
  }
  EXPECT_GT(ink_below, 50);
}

}  // namespace
}  // namespace pleat
