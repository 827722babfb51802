// The structure of a PNG (RFC 2083), byte by byte; its pixels are decoded in image_test.cpp.
#include <gtest/gtest.h>

#include <cstdint>

#include "pleat/render/image.h"

namespace pleat {
namespace {

uint32_t BigEndian(const std::string& bytes, size_t at) {
  uint32_t value = 0;
  for (size_t i = at; i < at + 4; ++i) value = value << 8 | static_cast<unsigned char>(bytes[i]);
  return value;
}

// CRC-32 of RFC 2083, appendix 15, bit by bit.
uint32_t Crc(const std::string& bytes) {
  uint32_t crc = 0xffffffffu;
  for (const char byte : bytes) {
    crc ^= static_cast<unsigned char>(byte);
    for (int bit = 0; bit < 8; ++bit) crc = crc & 1 ? 0xedb88320u ^ crc >> 1 : crc >> 1;
  }
  return ~crc;
}

TEST(PngTest, ChunksAreWholeAndTheirChecksumsRight) {
  for (const auto& [width, height] : {std::pair(1, 1), std::pair(37, 21), std::pair(300, 2)}) {
    const std::string png = EncodePng(Image(width, height));
    ASSERT_EQ(png.substr(0, 8), "\x89PNG\r\n\x1a\n");
    std::vector<std::string> kinds;
    size_t at = 8;
    while (at + 12 <= png.size()) {
      const uint32_t size = BigEndian(png, at);
      ASSERT_LE(at + 12 + size, png.size());
      kinds.push_back(png.substr(at + 4, 4));
      EXPECT_EQ(BigEndian(png, at + 8 + size), Crc(png.substr(at + 4, 4 + size)));
      at += 12 + size;
    }
    EXPECT_EQ(at, png.size());
    EXPECT_EQ(kinds.front(), "IHDR");
    EXPECT_EQ(kinds.back(), "IEND");
  }
}

TEST(PngTest, TheHeaderSaysSizeAndThreeBytesPerPixel) {
  const std::string png = EncodePng(Image(37, 21));
  EXPECT_EQ(BigEndian(png, 16), 37u);
  EXPECT_EQ(BigEndian(png, 20), 21u);
  EXPECT_EQ(png[24], 8);  // bits per channel
  EXPECT_EQ(png[25], 2);  // RGB
}

TEST(PngTest, TheSamePixelsGiveTheSameBytes) {
  Image image(12, 7);
  image.at(3, 4) = {200, 10, 30};
  const std::string png = EncodePng(image);
  EXPECT_EQ(EncodePng(image), png);
  image.at(3, 4) = {200, 10, 31};
  EXPECT_NE(EncodePng(image), png);
}

}  // namespace
}  // namespace pleat
