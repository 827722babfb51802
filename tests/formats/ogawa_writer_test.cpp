#include "ogawa_writer.h"

#include <gtest/gtest.h>

#include <vector>

namespace pleat {
namespace {

TEST(OgawaWriterTest, LayoutIsThePublishedOne) {
  OgawaWriter writer;
  const OgawaRef data = writer.AddData("bc", "a");
  EXPECT_EQ(data.bits, OgawaRef::kDataBit | 16);
  EXPECT_EQ(writer.ContentAt(data, 3), "abc");
  const std::string bytes = writer.Finish(writer.AddGroup(std::vector<OgawaRef>{data}));
  EXPECT_EQ(bytes, std::string("Ogawa\xff\0\1"
                               "\x1b\0\0\0\0\0\0\0"  // the root is at byte 27
                               "\3\0\0\0\0\0\0\0"
                               "abc"
                               "\1\0\0\0\0\0\0\0"
                               "\x10\0\0\0\0\0\0\x80",
                               43));
}

TEST(OgawaWriterTest, NothingTakesNoPlace) {
  OgawaWriter writer;
  EXPECT_EQ(writer.AddData("").bits, OgawaRef::kDataBit);
  EXPECT_EQ(writer.AddGroup(std::vector<OgawaRef>{}).bits, 0u);
  EXPECT_EQ(writer.Finish({}).size(), 16u);
}

}  // namespace
}  // namespace pleat
