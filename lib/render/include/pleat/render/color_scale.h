// Color scales for heat maps, with a labeled legend.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "pleat/render/image.h"

namespace pleat {

enum class ColorMap {
  kViridis,  // perceptually even, dark to bright (van der Walt and Smith 2015)
  kTurbo,    // rainbow without false edges (Mikhailov 2019)
};

// Returns the color of u in 0..1 (clamped; NaN counts as 0).
Rgb MapColor(ColorMap map, double u);

// Says what a color means: low .. high in `unit`.
struct ColorScale {
  ColorMap map = ColorMap::kTurbo;
  double low = 0, high = 1;
  std::string title;  // e.g. "distance"
  std::string unit = "mm";

  Rgb operator()(double value) const { return MapColor(map, (value - low) / (high - low)); }
};

// Returns one color per entry of `values`.
std::vector<Rgb> ColorValues(const ColorScale& scale,
                             const Eigen::Ref<const Eigen::VectorXd>& values);

// Draws a horizontal bar with round tick values below it and the title above.
Image DrawColorLegend(const ColorScale& scale, int width);

}  // namespace pleat
