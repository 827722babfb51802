#include "pleat/render/text.h"

#include <cmath>
#include <string>
#include <vector>

#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-function"
#include <stb/stb_easy_font.h>
#pragma GCC diagnostic pop

namespace pleat {
namespace {

constexpr int kLineHeight = 10;           // line of the font at scale 1, with descenders
constexpr int kBytesPerCharacter = 1024;  // far more than one glyph's quads take

std::string Printable(std::string_view text) {
  std::string printable(text);
  for (char& c : printable) {
    if (c < 32 || c > 126) c = '?';
  }
  return printable;
}

}  // namespace

int TextHeight(int scale) { return kLineHeight * scale; }

int TextWidth(std::string_view text, int scale) {
  std::string printable = Printable(text);
  return stb_easy_font_width(printable.data()) * scale;
}

void DrawText(Image* image, int left, int top, std::string_view text, int scale, Rgb color) {
  struct Corner {
    float x, y, z;
    unsigned char rgba[4];
  };
  std::string printable = Printable(text);
  std::vector<Corner> corners(kBytesPerCharacter / sizeof(Corner) * (printable.size() + 1));
  const int num_quads = stb_easy_font_print(0, 0, printable.data(), nullptr, corners.data(),
                                            static_cast<int>(corners.size() * sizeof(Corner)));
  for (int q = 0; q < num_quads; ++q) {  // axis-aligned boxes, first and third corner opposite
    const Corner& low = corners[4 * q];
    const Corner& high = corners[4 * q + 2];
    const int x0 = static_cast<int>(std::lround(low.x)), y0 = static_cast<int>(std::lround(low.y));
    const int x1 = static_cast<int>(std::lround(high.x));
    const int y1 = static_cast<int>(std::lround(high.y));
    image->FillRectangle(left + x0 * scale, top + y0 * scale, (x1 - x0) * scale, (y1 - y0) * scale,
                         color);
  }
}

}  // namespace pleat
