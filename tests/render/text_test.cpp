#include "pleat/render/text.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>

namespace pleat {
namespace {

// Pixels that are not white any more.
int CountInk(const Image& image) {
  int ink = 0;
  for (const Rgb& pixel : image.pixels()) ink += pixel == Rgb{255, 255, 255} ? 0 : 1;
  return ink;
}

Image Written(const std::string& text, int scale) {
  Image image(240, 50);
  DrawText(&image, 2, 2, text, scale, {0, 0, 0});
  return image;
}

TEST(Text, SetsPixelsInsideItsBoxOnly) {
  const Image image = Written("Frame 12, gjpq", 2);
  EXPECT_GT(CountInk(image), 300);
  for (int y = 0; y < image.height(); ++y) {
    for (int x = 0; x < image.width(); ++x) {
      if (image.at(x, y) == Rgb{255, 255, 255}) continue;
      EXPECT_GE(x, 2);
      EXPECT_LT(x, 2 + TextWidth("Frame 12, gjpq", 2));
      EXPECT_GE(y, 2);
      EXPECT_LT(y, 2 + TextHeight(2));
    }
  }
}

TEST(Text, IsSmoothAndReachesItsColor) {
  const Image image = Written("WWW", 2);
  int darkest = 255, grays = 0;
  for (const Rgb& pixel : image.pixels()) {
    darkest = std::min<int>(darkest, pixel.r);
    grays += pixel.r > 40 && pixel.r < 215;
  }
  EXPECT_LT(darkest, 20);
  EXPECT_GT(grays, 20);
}

TEST(Text, DifferentCharactersLookDifferent) {
  const std::string all = "0123456789abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ%().-";
  for (size_t i = 0; i < all.size(); ++i) {
    const Image image = Written(std::string(1, all[i]), 2);
    EXPECT_GT(CountInk(image), 0) << all[i];
    for (size_t j = i + 1; j < all.size(); ++j) {
      EXPECT_NE(image.pixels(), Written(std::string(1, all[j]), 2).pixels())
          << all[i] << " " << all[j];
    }
  }
}

TEST(Text, LargerScalesAreLargerAndOddBytesDoNoHarm) {
  EXPECT_GT(TextWidth("abc", 2), 1.4 * TextWidth("abc", 1));
  EXPECT_GT(TextHeight(2), TextHeight(1));
  EXPECT_EQ(TextWidth("", 1), 0);
  EXPECT_EQ(CountInk(Written("", 1)), 0);
  EXPECT_EQ(Written("\n", 1).pixels(), Written("?", 1).pixels());
  EXPECT_GT(CountInk(Written("\xff", 2)), 0);
  EXPECT_GT(CountInk(Written("\xc3\xa4", 2)), CountInk(Written("a", 2)));  // with its dots
  EXPECT_GT(TextWidth(std::string(1'000'000, 'x'), 1), 1000);
}

}  // namespace
}  // namespace pleat
