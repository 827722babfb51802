#include "pleat/render/image.h"

#include <algorithm>
#include <cmath>

namespace pleat {

void Image::FillRectangle(int left, int top, int width, int height, Rgb color) {
  const int right = std::min(left + width, width_), bottom = std::min(top + height, height_);
  for (int y = std::max(top, 0); y < bottom; ++y) {
    for (int x = std::max(left, 0); x < right; ++x) at(x, y) = color;
  }
}

void Image::Paste(const Image& source, int left, int top) {
  for (int y = 0; y < source.height(); ++y) {
    for (int x = 0; x < source.width(); ++x) {
      if (Contains(left + x, top + y)) at(left + x, top + y) = source.at(x, y);
    }
  }
}

void Image::Blend(int x, int y, double opacity, Rgb color) {
  if (!Contains(x, y) || opacity <= 0) return;
  Rgb& pixel = at(x, y);
  const auto mix = [opacity](uint8_t below, uint8_t above) {
    return static_cast<uint8_t>(std::lround(below + std::min(opacity, 1.0) * (above - below)));
  };
  pixel = {mix(pixel.r, color.r), mix(pixel.g, color.g), mix(pixel.b, color.b)};
}

// The opacity of a pixel falls linearly over one pixel at the line's edge, by the distance of its
// center from the segment. Ends are round, which DrawDot() uses.
void Image::DrawLine(double x0, double y0, double x1, double y1, double thickness, Rgb color) {
  const double dx = x1 - x0, dy = y1 - y0;
  const double length_squared = std::max(dx * dx + dy * dy, 1e-12);
  const double reach = thickness / 2 + 1;
  const int left = std::max(0, static_cast<int>(std::floor(std::min(x0, x1) - reach)));
  const int right = std::min(width_ - 1, static_cast<int>(std::ceil(std::max(x0, x1) + reach)));
  const int top = std::max(0, static_cast<int>(std::floor(std::min(y0, y1) - reach)));
  const int bottom = std::min(height_ - 1, static_cast<int>(std::ceil(std::max(y0, y1) + reach)));
  for (int y = top; y <= bottom; ++y) {
    for (int x = left; x <= right; ++x) {
      const double t = std::clamp(((x - x0) * dx + (y - y0) * dy) / length_squared, 0.0, 1.0);
      const double distance = std::hypot(x - x0 - t * dx, y - y0 - t * dy);
      Blend(x, y, thickness / 2 + .5 - distance, color);
    }
  }
}

void Image::DrawDot(double x, double y, double radius, Rgb color) {
  DrawLine(x, y, x, y, 2 * radius, color);
}

}  // namespace pleat
