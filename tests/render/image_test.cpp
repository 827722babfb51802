#include "pleat/render/image.h"

#define STB_IMAGE_STATIC
#define STB_IMAGE_IMPLEMENTATION
#define STBI_ONLY_PNG
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-function"
#include <stb/stb_image.h>
#pragma GCC diagnostic pop

#include <gtest/gtest.h>

#include <cstring>

namespace pleat {
namespace {

TEST(Image, PngDecodesToTheSamePixels) {
  Image image(37, 21);
  for (int y = 0; y < 21; ++y) {
    for (int x = 0; x < 37; ++x) {
      image.at(x, y) = {static_cast<uint8_t>(7 * x), static_cast<uint8_t>(11 * y),
                        static_cast<uint8_t>(x * y)};
    }
  }
  const std::string png = EncodePng(image);
  int width = 0, height = 0, channels = 0;
  unsigned char* decoded =
      stbi_load_from_memory(reinterpret_cast<const unsigned char*>(png.data()),
                            static_cast<int>(png.size()), &width, &height, &channels, 3);
  ASSERT_NE(decoded, nullptr);
  EXPECT_EQ(width, 37);
  EXPECT_EQ(height, 21);
  EXPECT_EQ(channels, 3);
  EXPECT_EQ(std::memcmp(decoded, image.pixels().data(), 37 * 21 * 3), 0);
  stbi_image_free(decoded);
}

TEST(Image, DrawingClipsAtTheBorders) {
  Image image(20, 10);
  image.FillRectangle(-5, -5, 8, 8, {1, 2, 3});
  EXPECT_EQ(image.at(2, 2), (Rgb{1, 2, 3}));
  EXPECT_EQ(image.at(3, 2), (Rgb{255, 255, 255}));
  image.DrawLine(-100, 5, 100, 5, 1, {0, 0, 0});
  EXPECT_EQ(image.at(0, 5), (Rgb{0, 0, 0}));
  EXPECT_EQ(image.at(19, 5), (Rgb{0, 0, 0}));
  EXPECT_EQ(image.at(10, 8), (Rgb{255, 255, 255}));
  image.DrawDot(500, 500, 3, {9, 9, 9});  // far outside: nothing happens
  image.Paste(Image(4, 4, {5, 5, 5}), 18, 8);
  EXPECT_EQ(image.at(19, 9), (Rgb{5, 5, 5}));
}

}  // namespace
}  // namespace pleat
