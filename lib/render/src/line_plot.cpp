#include "pleat/render/line_plot.h"

#include <cairo-svg.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <numbers>
#include <utility>

#include "absl/strings/str_cat.h"
#include "cairo_owners.h"
#include "cairo_text.h"
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
constexpr int kLegendTop = 30, kLegendLine = 16, kSwatch = 18, kLegendSpace = 16, kLeft = 64,
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
  Plot(cairo_t* cairo, const LinePlotOptions& options, std::vector<LegendPlace> legend, Range x,
       Range y)
      : cairo_(cairo), legend_(std::move(legend)), x_(x), y_(y) {
    right_ = options.width - kRightMargin;
    // At least half of the picture is left to the curves.
    top_ = std::min((legend_.empty() ? kLegendTop : legend_.back().y + kLegendLine) + kLegendLine,
                    options.height / 2);
    bottom_ = options.height - 40;
    Fill(0, 0, options.width, options.height, {255, 255, 255});
  }

  void DrawFrame(const LinePlotOptions& options);
  void DrawLegend(const std::vector<PlotSeries>& series);
  void DrawSeries(const PlotSeries& series, double first_x, Rgb color);

 private:
  double X(double x) const { return kLeft + (x - x_.low) / (x_.high - x_.low) * (right_ - kLeft); }
  double Y(double y) const {
    return bottom_ - (y - y_.low) / (y_.high - y_.low) * (bottom_ - top_);
  }
  void Fill(double left, double top, double width, double height, Rgb color) {
    SelectColor(cairo_, color);
    cairo_rectangle(cairo_, left, top, width, height);
    cairo_fill(cairo_);
  }
  void Text(double left, double top, const std::string& text, int scale = 1) {
    SelectColor(cairo_, kAxisInk);
    ShowText(cairo_, left, top, text, scale);
  }

  cairo_t* const cairo_;
  std::vector<LegendPlace> legend_;
  Range x_, y_;
  int right_, top_, bottom_;
};

void Plot::DrawFrame(const LinePlotOptions& options) {
  Text(kLeft, 4, options.title, 2);
  const auto step = [](const std::vector<double>& ticks) {
    return ticks.size() > 1 ? ticks[1] - ticks[0] : 1.0;
  };
  const std::vector<double> y_ticks = RoundTicks(y_.low, y_.high, 7);
  for (double tick : y_ticks) {
    const int y = static_cast<int>(std::lround(Y(tick)));
    Fill(kLeft, y, right_ - kLeft, 1, kGrid);
    const std::string label = TickLabel(tick, step(y_ticks));
    Text(kLeft - 6 - TextWidth(label, 1), y - TextHeight(1) / 2, label);
  }
  const std::vector<double> x_ticks = RoundTicks(x_.low, x_.high, 12);
  for (double tick : x_ticks) {
    const int x = static_cast<int>(std::lround(X(tick)));
    Fill(x, top_, 1, bottom_ - top_, kGrid);
    const std::string label = TickLabel(tick, step(x_ticks));
    Text(x - TextWidth(label, 1) / 2, bottom_ + 4, label);
  }
  Fill(kLeft, top_, 1, bottom_ - top_, kAxis);
  Fill(kLeft, bottom_, right_ - kLeft, 1, kAxis);
  Text((kLeft + right_ - TextWidth(options.x_label, 1)) / 2, bottom_ + 21, options.x_label);
  Text(6, top_ - kLegendLine - 1, options.y_label);  // above the axis
}

void Plot::DrawLegend(const std::vector<PlotSeries>& series) {
  for (size_t i = 0; i < series.size(); ++i) {
    const auto [x, y] = legend_[i];
    Fill(x, y + 5, kSwatch - 5, 3, kPalette[i % kPalette.size()]);
    Text(x + kSwatch, y, series[i].name);
  }
}

void Plot::DrawSeries(const PlotSeries& series, double first_x, Rgb color) {
  const std::vector<double>& values = series.values;
  SelectColor(cairo_, color);
  cairo_set_line_width(cairo_, 2);
  cairo_set_line_join(cairo_, CAIRO_LINE_JOIN_ROUND);
  for (size_t i = 0; i < values.size(); ++i) {
    if (!std::isfinite(values[i])) continue;
    const double x = X(first_x + static_cast<double>(i)), y = Y(values[i]);
    const bool follows = i > 0 && std::isfinite(values[i - 1]);
    const bool leads = i + 1 < values.size() && std::isfinite(values[i + 1]);
    if (follows) {
      cairo_line_to(cairo_, x, y);
    } else if (leads) {
      cairo_move_to(cairo_, x, y);
    }
    if (follows && !leads) cairo_stroke(cairo_);
    if (!follows && !leads) {
      cairo_arc(cairo_, x, y, 2.5, 0, 2 * std::numbers::pi);
      cairo_fill(cairo_);
    }
  }
}

// What is drawn, once the values are known to be good.
struct PreparedPlot {
  Range x, y;
};

absl::StatusOr<PreparedPlot> Prepare(const std::vector<PlotSeries>& series,
                                     const LinePlotOptions& options) {
  if (std::min(options.width, options.height) < 160 ||
      std::max(options.width, options.height) > 8192) {
    return absl::InvalidArgumentError(absl::StrCat("line plot: ", options.width, " x ",
                                                   options.height,
                                                   " pixels; each side must be 160 to 8192"));
  }
  PreparedPlot plot;
  for (const PlotSeries& s : series) {
    for (size_t i = 0; i < s.values.size(); ++i) {
      if (!std::isfinite(s.values[i])) continue;
      plot.x.Include(options.first_x + static_cast<double>(i));
      plot.y.Include(s.values[i]);
    }
  }
  if (plot.y.empty()) return absl::InvalidArgumentError("line plot: no finite value to draw");
  if (options.y_from_zero) plot.y.Include(0);
  plot.x.Widen();
  plot.y.Widen();
  plot.y.high += .04 * (plot.y.high - plot.y.low);
  return plot;
}

absl::Status DrawPlot(cairo_surface_t* surface, const PreparedPlot& prepared,
                      const std::vector<PlotSeries>& series, const LinePlotOptions& options) {
  const CairoContext cairo(cairo_create(surface));
  Plot plot(cairo.get(), options, PlaceLegend(series, options.width), prepared.x, prepared.y);
  plot.DrawFrame(options);
  for (size_t i = 0; i < series.size(); ++i) {
    plot.DrawSeries(series[i], options.first_x, kPalette[i % kPalette.size()]);
  }
  plot.DrawLegend(series);
  cairo_surface_flush(surface);
  const cairo_status_t status = cairo_status(cairo.get());
  if (status == CAIRO_STATUS_SUCCESS) return absl::OkStatus();
  return absl::InternalError(absl::StrCat("line plot: ", cairo_status_to_string(status)));
}

}  // namespace

absl::StatusOr<Image> RenderLinePlot(const std::vector<PlotSeries>& series,
                                     const LinePlotOptions& options) {
  PLEAT_ASSIGN_OR_RETURN(const PreparedPlot prepared, Prepare(series, options));
  const CairoSurface surface(
      cairo_image_surface_create(CAIRO_FORMAT_RGB24, options.width, options.height));
  PLEAT_RETURN_IF_ERROR(DrawPlot(surface.get(), prepared, series, options));
  const auto* const bytes = cairo_image_surface_get_data(surface.get());
  const int stride = cairo_image_surface_get_stride(surface.get());
  Image image(options.width, options.height);
  for (int y = 0; y < options.height; ++y) {
    for (int x = 0; x < options.width; ++x) {
      uint32_t pixel = 0;  // 0x00rrggbb in the order of the machine
      std::memcpy(&pixel, bytes + ptrdiff_t{y} * stride + ptrdiff_t{x} * 4, sizeof(pixel));
      image.at(x, y) = {static_cast<uint8_t>(pixel >> 16), static_cast<uint8_t>(pixel >> 8),
                        static_cast<uint8_t>(pixel)};
    }
  }
  return image;
}

absl::StatusOr<std::string> RenderLinePlotSvg(const std::vector<PlotSeries>& series,
                                              const LinePlotOptions& options) {
  PLEAT_ASSIGN_OR_RETURN(const PreparedPlot prepared, Prepare(series, options));
  std::string svg;
  const auto append = [](void* text, const unsigned char* data, unsigned size) {
    static_cast<std::string*>(text)->append(reinterpret_cast<const char*>(data), size);
    return CAIRO_STATUS_SUCCESS;
  };
  {
    const CairoSurface surface(
        cairo_svg_surface_create_for_stream(append, &svg, options.width, options.height));
    PLEAT_RETURN_IF_ERROR(DrawPlot(surface.get(), prepared, series, options));
    cairo_surface_finish(surface.get());
  }
  return svg;
}

absl::StatusOr<std::string> EncodeLinePlot(const std::string& path,
                                           const std::vector<PlotSeries>& series,
                                           const LinePlotOptions& options) {
  if (path.ends_with(".svg")) return RenderLinePlotSvg(series, options);
  PLEAT_ASSIGN_OR_RETURN(const Image image, RenderLinePlot(series, options));
  return EncodePng(image);
}

}  // namespace pleat
