// Curves over a common axis, such as the error of every frame for several learners.
#pragma once

#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "pleat/render/image.h"

namespace pleat {

struct PlotSeries {
  std::string name;            // in the legend
  std::vector<double> values;  // y at x = first_x, first_x + 1, ...; NaN leaves a gap
};

struct LinePlotOptions {
  int width = 800, height = 360;                  // pixels, 160 .. 8192
  std::string title, x_label = "frame", y_label;  // labels name their unit: "mean error (mm)"
  double first_x = 0;
  bool y_from_zero = true;
};

// Draws the plot. The error is kInvalidArgument when no series holds a finite value or the size is
// out of range.
absl::StatusOr<Image> RenderLinePlot(const std::vector<PlotSeries>& series,
                                     const LinePlotOptions& options);
// The same as SVG, whose text is outlines.
absl::StatusOr<std::string> RenderLinePlotSvg(const std::vector<PlotSeries>& series,
                                              const LinePlotOptions& options);
// A file of a plot: SVG where `path` ends in .svg, and otherwise PNG.
absl::StatusOr<std::string> EncodeLinePlot(const std::string& path,
                                           const std::vector<PlotSeries>& series,
                                           const LinePlotOptions& options);

}  // namespace pleat
