#include "pleat/render/line_plot.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "absl/strings/str_cat.h"
#include "pleat/base/status.h"
#include "pleat/render/text.h"
#include "ticks.h"

namespace pleat {
namespace {

constexpr Rgb kAxisInk{40, 40, 40}, kGrid{228, 228, 228}, kAxis{120, 120, 120};
// The palette of Okabe and Ito (2008), which color-blind readers can tell apart, too.
constexpr std::array<Rgb, 7> kPalette = {{{0, 114, 178},
                                          {213, 94, 0},
                                          {0, 158, 115},
                                          {204, 121, 167},
                                          {230, 159, 0},
                                          {86, 180, 233},
                                          {60, 60, 60}}};

struct Range {
  double low = std::numeric_limits<double>::infinity(), high = -low;

  void Include(double value) {
    low = std::min(low, value);
    high = std::max(high, value);
  }
  bool empty() const { return low > high; }
  void Widen() {  // never of zero length
    if (high > low) return;
    const double half = std::max(std::abs(low) * .5, .5);
    low -= half;
    high += half;
  }
};

// The place of an entry of the legend: rows from the left, below the title.
struct LegendPlace {
  int x, y;
};
constexpr int kLegendTop = 26, kLegendLine = 14, kSwatch = 18, kLegendSpace = 16, kLeft = 64,
              kRightMargin = 16;

std::vector<LegendPlace> PlaceLegend(const std::vector<PlotSeries>& series, int width) {
  std::vector<LegendPlace> places;
  int x = kLeft, y = kLegendTop;
  for (const PlotSeries& s : series) {
    const int entry = kSwatch + TextWidth(s.name, 1) + kLegendSpace;
    if (x > kLeft && x + entry > width - kRightMargin) {
      x = kLeft;
      y += kLegendLine;
    }
    places.push_back({x, y});
    x += entry;
  }
  return places;
}

// Draws one plot: the frame with its axes first, then the curves over the grid, the legend last.
class Plot {
 public:
  Plot(const LinePlotOptions& options, std::vector<LegendPlace> legend, Range x, Range y)
      : image_(options.width, options.height), legend_(std::move(legend)), x_(x), y_(y) {
    right_ = options.width - kRightMargin;
    // At least half of the picture is left to the curves.
    top_ = std::min((legend_.empty() ? kLegendTop : legend_.back().y + kLegendLine) + kLegendLine,
                    options.height / 2);
    bottom_ = options.height - 40;
  }

  void DrawFrame(const LinePlotOptions& options);
  void DrawLegend(const std::vector<PlotSeries>& series);
  void DrawSeries(const PlotSeries& series, double first_x, Rgb color);
  Image Release() { return std::move(image_); }

 private:
  double X(double x) const { return kLeft + (x - x_.low) / (x_.high - x_.low) * (right_ - kLeft); }
  double Y(double y) const {
    return bottom_ - (y - y_.low) / (y_.high - y_.low) * (bottom_ - top_);
  }

  Image image_;
  std::vector<LegendPlace> legend_;
  Range x_, y_;
  int right_, top_, bottom_;
};

void Plot::DrawFrame(const LinePlotOptions& options) {
  DrawText(&image_, kLeft, 4, options.title, 2, kAxisInk);
  const auto step = [](const std::vector<double>& ticks) {
    return ticks.size() > 1 ? ticks[1] - ticks[0] : 1.0;
  };
  const std::vector<double> y_ticks = RoundTicks(y_.low, y_.high, 7);
  for (double tick : y_ticks) {
    const int y = static_cast<int>(std::lround(Y(tick)));
    image_.FillRectangle(kLeft, y, right_ - kLeft, 1, kGrid);
    const std::string label = TickLabel(tick, step(y_ticks));
    DrawText(&image_, kLeft - 6 - TextWidth(label, 1), y - 4, label, 1, kAxisInk);
  }
  const std::vector<double> x_ticks = RoundTicks(x_.low, x_.high, 12);
  for (double tick : x_ticks) {
    const int x = static_cast<int>(std::lround(X(tick)));
    image_.FillRectangle(x, top_, 1, bottom_ - top_, kGrid);
    const std::string label = TickLabel(tick, step(x_ticks));
    DrawText(&image_, x - TextWidth(label, 1) / 2, bottom_ + 6, label, 1, kAxisInk);
  }
  image_.FillRectangle(kLeft, top_, 1, bottom_ - top_, kAxis);
  image_.FillRectangle(kLeft, bottom_, right_ - kLeft, 1, kAxis);
  DrawText(&image_, (kLeft + right_ - TextWidth(options.x_label, 1)) / 2, bottom_ + 22,
           options.x_label, 1, kAxisInk);
  DrawText(&image_, 6, top_ - kLegendLine, options.y_label, 1, kAxisInk);  // above the axis
}

void Plot::DrawLegend(const std::vector<PlotSeries>& series) {
  for (size_t i = 0; i < series.size(); ++i) {
    const auto [x, y] = legend_[i];
    image_.FillRectangle(x, y + 3, kSwatch - 5, 3, kPalette[i % kPalette.size()]);
    DrawText(&image_, x + kSwatch, y, series[i].name, 1, kAxisInk);
  }
}

void Plot::DrawSeries(const PlotSeries& series, double first_x, Rgb color) {
  const std::vector<double>& values = series.values;
  for (size_t i = 0; i < values.size(); ++i) {
    if (!std::isfinite(values[i])) continue;
    const double x = X(first_x + static_cast<double>(i)), y = Y(values[i]);
    const bool follows = i > 0 && std::isfinite(values[i - 1]);
    const bool leads = i + 1 < values.size() && std::isfinite(values[i + 1]);
    if (follows) image_.DrawLine(X(first_x + i - 1.), Y(values[i - 1]), x, y, 1.5, color);
    if (!follows && !leads) image_.DrawDot(x, y, 2, color);
  }
}

}  // namespace

absl::StatusOr<Image> RenderLinePlot(const std::vector<PlotSeries>& series,
                                     const LinePlotOptions& options) {
  if (std::min(options.width, options.height) < 160 ||
      std::max(options.width, options.height) > 8192) {
    return absl::InvalidArgumentError(absl::StrCat("line plot: ", options.width, " x ",
                                                   options.height,
                                                   " pixels; each side must be 160 to 8192"));
  }
  Range x, y;
  for (const PlotSeries& s : series) {
    for (size_t i = 0; i < s.values.size(); ++i) {
      if (!std::isfinite(s.values[i])) continue;
      x.Include(options.first_x + static_cast<double>(i));
      y.Include(s.values[i]);
    }
  }
  if (y.empty()) return absl::InvalidArgumentError("line plot: no finite value to draw");
  if (options.y_from_zero) y.Include(0);
  x.Widen();
  y.Widen();
  y.high += .04 * (y.high - y.low);

  Plot plot(options, PlaceLegend(series, options.width), x, y);
  plot.DrawFrame(options);
  for (size_t i = 0; i < series.size(); ++i) {
    plot.DrawSeries(series[i], options.first_x, kPalette[i % kPalette.size()]);
  }
  plot.DrawLegend(series);
  return plot.Release();
}

}  // namespace pleat
