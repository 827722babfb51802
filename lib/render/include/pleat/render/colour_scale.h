// Colour scales for heat maps, with a labelled legend.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "pleat/render/image.h"

namespace pleat {

enum class ColourMap {
  kViridis,  // perceptually even, dark to bright (van der Walt and Smith 2015)
  kTurbo,    // rainbow without false edges (Mikhailov 2019)
};

// u in 0..1 (clamped).
Rgb MapColour(ColourMap map, double u);

// What a colour means: low .. high in `unit`.
struct ColourScale {
  ColourMap map = ColourMap::kTurbo;
  double low = 0, high = 1;
  std::string title;  // e.g. "distance"
  std::string unit = "mm";

  Rgb operator()(double value) const { return MapColour(map, (value - low) / (high - low)); }
};

// One colour per entry of `values`.
std::vector<Rgb> ColourValues(const ColourScale& scale,
                              const Eigen::Ref<const Eigen::VectorXd>& values);

// A horizontal bar with round tick values below it and the title above.
Image DrawColourLegend(const ColourScale& scale, int width);

}  // namespace pleat
