#include "pleat/render/text.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>

#include "cairo_owners.h"
#include "cairo_text.h"
#include "pleat/base/utf8.h"

namespace pleat {
namespace {

constexpr char kFont[] = "DejaVu Sans";  // where it is not there, the system takes another one
constexpr int kMaxTextBytes = 2000;

double FontPixels(int scale) { return 4 + 7. * scale; }

std::string Printable(std::string_view text) {
  std::string printable = ToValidUtf8(text.substr(0, kMaxTextBytes));
  for (char& c : printable) {
    if (static_cast<unsigned char>(c) < 32 || c == 127) c = '?';
  }
  return printable;
}

// Something to measure on.
CairoContext MakeScratch() {
  const CairoSurface surface(cairo_image_surface_create(CAIRO_FORMAT_A8, 1, 1));
  return CairoContext(cairo_create(surface.get()));
}

cairo_font_extents_t ExtentsOf(cairo_t* cairo, int scale) {
  SelectFont(cairo, scale);
  cairo_font_extents_t extents;
  cairo_font_extents(cairo, &extents);
  return extents;
}

}  // namespace

void SelectFont(cairo_t* cairo, int scale) {
  cairo_select_font_face(cairo, kFont, CAIRO_FONT_SLANT_NORMAL, CAIRO_FONT_WEIGHT_NORMAL);
  cairo_set_font_size(cairo, FontPixels(scale));
}

void SelectColor(cairo_t* cairo, Rgb color) {
  cairo_set_source_rgb(cairo, color.r / 255., color.g / 255., color.b / 255.);
}

void ShowText(cairo_t* cairo, double left, double top, std::string_view text, int scale) {
  const cairo_font_extents_t extents = ExtentsOf(cairo, scale);
  cairo_move_to(cairo, left, top + extents.ascent);
  cairo_show_text(cairo, Printable(text).c_str());
}

int TextHeight(int scale) {
  const CairoContext cairo = MakeScratch();
  const cairo_font_extents_t extents = ExtentsOf(cairo.get(), scale);
  return static_cast<int>(std::ceil(extents.ascent + extents.descent));
}

int TextWidth(std::string_view text, int scale) {
  const CairoContext cairo = MakeScratch();
  SelectFont(cairo.get(), scale);
  cairo_text_extents_t extents;
  cairo_text_extents(cairo.get(), Printable(text).c_str(), &extents);
  return static_cast<int>(
      std::ceil(std::max(extents.x_advance, extents.x_bearing + extents.width)));
}

void DrawText(Image* image, int left, int top, std::string_view text, int scale, Rgb color) {
  const int width = TextWidth(text, scale), height = TextHeight(scale);
  if (width == 0) return;
  const CairoSurface surface(cairo_image_surface_create(CAIRO_FORMAT_A8, width, height));
  const CairoContext cairo(cairo_create(surface.get()));
  ShowText(cairo.get(), 0, 0, text, scale);
  cairo_surface_flush(surface.get());
  const uint8_t* const coverage = cairo_image_surface_get_data(surface.get());
  if (coverage == nullptr) return;
  const int stride = cairo_image_surface_get_stride(surface.get());
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      image->Blend(left + x, top + y, coverage[y * stride + x] / 255., color);
    }
  }
}

}  // namespace pleat
