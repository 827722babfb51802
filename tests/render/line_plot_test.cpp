#include "pleat/render/line_plot.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>

#include "support/status_matchers.h"

namespace pleat {
namespace {

using ::testing::HasSubstr;

int CountColor(const Image& image, Rgb color) {
  int count = 0;
  for (const Rgb& pixel : image.pixels()) count += pixel == color;
  return count;
}

TEST(LinePlot, DrawsEverySeriesInItsOwnColor) {
  PlotSeries rising{"rising", {}}, flat{"flat", {}};
  for (int i = 0; i < 100; ++i) {
    rising.values.push_back(.1 * i);
    flat.values.push_back(5);
  }
  LinePlotOptions options;
  options.title = "error per frame";
  options.y_label = "mean (mm)";
  PLEAT_ASSERT_OK_AND_ASSIGN(const Image image, RenderLinePlot({rising, flat}, options));
  EXPECT_EQ(image.width(), 800);
  EXPECT_EQ(image.height(), 360);
  EXPECT_GT(CountColor(image, {213, 94, 0}), 400);  // second color: the horizontal line
  EXPECT_GT(CountColor(image, {0, 114, 178}), 100);
}

TEST(LinePlot, LeavesGapsAndTakesSinglePointsAndConstants) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(RenderLinePlot({{"gaps", {1, nan, 2, nan, nan, 3, 4}}}, {}), IsOk());
  EXPECT_THAT(RenderLinePlot({{"one", {3}}}, {}), IsOk());
  LinePlotOptions options;
  options.y_from_zero = false;
  EXPECT_THAT(RenderLinePlot({{"constant", {0, 0, 0}}}, options), IsOk());
  EXPECT_THAT(RenderLinePlot({{"huge", {-1e300, 1e300}}}, options), IsOk());
  EXPECT_THAT(RenderLinePlot({{"tiny", {1e-300, 2e-300}}}, options), IsOk());
}

TEST(LinePlot, LongLegendsTakeMoreRowsAndStayInside) {
  LinePlotOptions options;
  options.width = 300;
  std::vector<PlotSeries> series;
  for (int i = 0; i < 6; ++i) series.push_back({"a series with a long name", {0, double(i)}});
  PLEAT_ASSERT_OK_AND_ASSIGN(const Image image, RenderLinePlot(series, options));
  // One swatch below the other, and the curve of the last series somewhere below them.
  const Rgb first{0, 114, 178}, second{213, 94, 0};
  const auto highest = [&](Rgb color) {
    for (int y = 0; y < image.height(); ++y) {
      for (int x = 0; x < image.width(); ++x) {
        if (image.at(x, y) == color) return y;
      }
    }
    return image.height();
  };
  EXPECT_GT(highest(second), highest(first) + 5);
}

TEST(LinePlot, SvgHasTheSameCurves) {
  LinePlotOptions options;
  options.title = "error";
  PLEAT_ASSERT_OK_AND_ASSIGN(const std::string svg,
                             RenderLinePlotSvg({{"a", {1, 2, 3}}, {"b", {3, 2, 1}}}, options));
  EXPECT_THAT(svg, testing::StartsWith("<?xml"));
  EXPECT_THAT(svg, HasSubstr("</svg>"));
  EXPECT_THAT(svg, HasSubstr("stroke-width"));
  EXPECT_THAT(RenderLinePlotSvg({}, {}),
              HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("no finite value")));
}

TEST(LinePlot, RefusesNothingToDraw) {
  EXPECT_THAT(RenderLinePlot({}, {}),
              HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("no finite value")));
  EXPECT_THAT(RenderLinePlot({{"nan", {std::nan("")}}}, {}),
              HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("no finite value")));
  LinePlotOptions options;
  options.width = 3;
  EXPECT_THAT(RenderLinePlot({{"a", {1, 2}}}, options),
              HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("160 to 8192")));
}

}  // namespace
}  // namespace pleat
