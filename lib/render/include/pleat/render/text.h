// Draws text with Cairo, in DejaVu Sans where it is installed.
#pragma once

#include <string_view>

#include "pleat/render/image.h"

namespace pleat {

// The height of a line of text and the width of `text`, in pixels. scale: 1 for labels (11 pixels),
// 2 for titles (18), and so on.
int TextHeight(int scale);
int TextWidth(std::string_view text, int scale);

// Draws one line of UTF-8 with its top left corner at (left, top). Control characters become '?',
// what is no UTF-8 a mark; what is longer than any picture is cut.
void DrawText(Image* image, int left, int top, std::string_view text, int scale, Rgb color);

}  // namespace pleat
