#include "pleat/render/text.h"

#include <gtest/gtest.h>

namespace pleat {
namespace {

int CountInk(const Image& image) {
  int ink = 0;
  for (const Rgb& pixel : image.pixels()) ink += pixel == Rgb{0, 0, 0};
  return ink;
}

Image Written(const char* text, int scale) {
  Image image(200, 40);
  DrawText(&image, 2, 2, text, scale, {0, 0, 0});
  return image;
}

TEST(Text, SetsPixelsInsideItsBoxOnly) {
  const Image image = Written("Frame 12", 2);
  EXPECT_GT(CountInk(image), 100);
  for (int y = 0; y < image.height(); ++y) {
    for (int x = 0; x < image.width(); ++x) {
      if (image.at(x, y) == Rgb{0, 0, 0}) {
        EXPECT_GE(x, 2);
        EXPECT_LT(x, 2 + TextWidth("Frame 12", 2));
        EXPECT_GE(y, 2);
        EXPECT_LT(y, 2 + TextHeight(2) + 4);
      }
    }
  }
}

TEST(Text, DifferentCharactersLookDifferent) {
  const std::string all = "0123456789abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ%().-";
  for (size_t i = 0; i < all.size(); ++i) {
    const std::string a(1, all[i]);
    EXPECT_GT(CountInk(Written(a.c_str(), 1)), 0) << a;
    for (size_t j = i + 1; j < all.size(); ++j) {
      const std::string b(1, all[j]);
      EXPECT_NE(Written(a.c_str(), 1).pixels(), Written(b.c_str(), 1).pixels()) << a << " " << b;
    }
  }
}

TEST(Text, ScaleMultipliesAndOddCharactersBecomeQuestionMarks) {
  EXPECT_EQ(TextWidth("abc", 3), 3 * TextWidth("abc", 1));
  EXPECT_EQ(CountInk(Written("8", 2)), 4 * CountInk(Written("8", 1)));
  EXPECT_EQ(Written("\xff", 1).pixels(), Written("?", 1).pixels());
  EXPECT_EQ(CountInk(Written("", 1)), 0);
}

}  // namespace
}  // namespace pleat
