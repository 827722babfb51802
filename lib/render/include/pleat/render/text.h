// Draws text in a small bitmap font (stb_easy_font), so that pictures need no font file.
#pragma once

#include <string_view>

#include "pleat/render/image.h"

namespace pleat {

// The height of a line of text and the width of `text`, in pixels, at a whole-number `scale`.
int TextHeight(int scale);
int TextWidth(std::string_view text, int scale);

// Draws one line with its top left corner at (left, top). Characters outside of printable ASCII
// become '?'.
void DrawText(Image* image, int left, int top, std::string_view text, int scale, Rgb color);

}  // namespace pleat
