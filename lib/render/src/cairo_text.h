// Text with Cairo, on whatever it draws on.
#pragma once

#include <cairo.h>

#include <string_view>

#include "pleat/render/image.h"

namespace pleat {

// Chooses the font of all pictures in the size of `scale` (text.h).
void SelectFont(cairo_t* cairo, int scale);
void SelectColor(cairo_t* cairo, Rgb color);
// Draws one line with its top left corner at (left, top), with the selected color.
void ShowText(cairo_t* cairo, double left, double top, std::string_view text, int scale);

}  // namespace pleat
