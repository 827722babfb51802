// Both maps are short piecewise-linear tables sampled from the published ones; the difference
// cannot be seen in 8 bits of a picture.
#include "pleat/render/color_scale.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "absl/strings/str_cat.h"
#include "pleat/render/text.h"
#include "ticks.h"

namespace pleat {
namespace {

constexpr std::array<Rgb, 9> kViridisTable = {{{68, 1, 84},
                                               {71, 44, 122},
                                               {59, 81, 139},
                                               {44, 113, 142},
                                               {33, 144, 141},
                                               {39, 173, 129},
                                               {92, 200, 99},
                                               {170, 220, 50},
                                               {253, 231, 37}}};
constexpr std::array<Rgb, 11> kTurboTable = {{{48, 18, 59},
                                              {66, 88, 201},
                                              {65, 144, 254},
                                              {27, 196, 226},
                                              {38, 236, 166},
                                              {124, 254, 91},
                                              {195, 241, 52},
                                              {244, 199, 58},
                                              {252, 139, 37},
                                              {217, 56, 6},
                                              {122, 4, 3}}};

template <size_t N>
Rgb Lookup(const std::array<Rgb, N>& table, double u) {
  const double position = std::clamp(u, 0.0, 1.0) * (N - 1);
  const size_t i = std::min(static_cast<size_t>(position), N - 2);
  const double t = position - static_cast<double>(i);
  const auto mix = [t](uint8_t a, uint8_t b) {
    return static_cast<uint8_t>(std::lround(a + t * (b - a)));
  };
  const Rgb& a = table[i];
  const Rgb& b = table[i + 1];
  return {mix(a.r, b.r), mix(a.g, b.g), mix(a.b, b.b)};
}

}  // namespace

Rgb MapColor(ColorMap map, double u) {
  if (!(u >= 0)) u = 0;  // NaN included
  return map == ColorMap::kViridis ? Lookup(kViridisTable, u) : Lookup(kTurboTable, u);
}

std::vector<Rgb> ColorValues(const ColorScale& scale,
                             const Eigen::Ref<const Eigen::VectorXd>& values) {
  std::vector<Rgb> colors;
  colors.reserve(values.size());
  for (double value : values) colors.push_back(scale(value));
  return colors;
}

Image DrawColorLegend(const ColorScale& scale, int width) {
  constexpr int kBarHeight = 14, kMargin = 30, kTop = 14, kHeight = 46;
  const Rgb ink{40, 40, 40};
  Image legend(width, kHeight);
  const int bar_width = std::max(width - 2 * kMargin, 1);
  DrawText(&legend, kMargin, 1, absl::StrCat(scale.title, " (", scale.unit, ")"), 1, ink);
  for (int x = 0; x < bar_width; ++x) {
    legend.FillRectangle(kMargin + x, kTop, 1, kBarHeight,
                         MapColor(scale.map, (x + .5) / bar_width));
  }
  const std::vector<double> ticks = RoundTicks(scale.low, scale.high, 5);
  const double step = ticks.size() > 1 ? ticks[1] - ticks[0] : scale.high - scale.low;
  for (double tick : ticks) {
    const int x =
        kMargin +
        static_cast<int>(std::lround((tick - scale.low) / (scale.high - scale.low) * bar_width));
    legend.FillRectangle(x, kTop + kBarHeight, 1, 4, ink);
    const std::string label = TickLabel(tick, step);
    DrawText(&legend, x - TextWidth(label, 1) / 2, kTop + kBarHeight + 6, label, 1, ink);
  }
  return legend;
}

}  // namespace pleat
