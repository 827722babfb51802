// A picture of 8-bit sRGB pixels and its PNG bytes.
#pragma once

#include <cassert>
#include <cstdint>
#include <string>
#include <vector>

namespace pleat {

struct Rgb {
  uint8_t r = 0, g = 0, b = 0;
  friend bool operator==(const Rgb&, const Rgb&) = default;
};

class Image {
 public:
  static constexpr int kMaxSide = 32768;

  // width, height: 1 .. kMaxSide.
  Image(int width, int height, Rgb fill = {255, 255, 255})
      : width_(width), height_(height), pixels_(static_cast<size_t>(width) * height, fill) {
    assert(width > 0 && height > 0 && width <= kMaxSide && height <= kMaxSide);
  }

  int width() const { return width_; }
  int height() const { return height_; }
  bool Contains(int x, int y) const { return x >= 0 && y >= 0 && x < width_ && y < height_; }
  // x to the right, y down; must be inside.
  const Rgb& at(int x, int y) const { return pixels_[static_cast<size_t>(y) * width_ + x]; }
  Rgb& at(int x, int y) { return pixels_[static_cast<size_t>(y) * width_ + x]; }
  const std::vector<Rgb>& pixels() const { return pixels_; }  // rows from the top

  // Everything below clips at the borders.
  void FillRectangle(int left, int top, int width, int height, Rgb color);
  void Paste(const Image& source, int left, int top);
  // Draws an anti-aliased line from (x0, y0) to (x1, y1); pixel centers lie at whole numbers.
  void DrawLine(double x0, double y0, double x1, double y1, double thickness, Rgb color);
  void DrawDot(double x, double y, double radius, Rgb color);
  // Mixes the color into a pixel. opacity: 0 to 1.
  void Blend(int x, int y, double opacity, Rgb color);

 private:
  int width_, height_;
  std::vector<Rgb> pixels_;
};

// Returns the bytes of a PNG file, or nothing when there is no memory for them.
std::string EncodePng(const Image& image);

}  // namespace pleat
